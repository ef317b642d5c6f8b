/** \file
 * \brief Three fields of a PCLPointCloud2 as one vector, of 32 or 64 bits alike.
 */
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace bayesian_icp::io {

/** \brief Where x, y, z (or the like) are within a point of a cloud. */
class FieldTriple {
public:
  /** \brief Look for fields by name; each is taken where it comes first. */
  FieldTriple(const pcl::PCLPointCloud2& cloud, const std::array<const char*, 3>& names)
  {
    for (const char* name : names)
      for (const pcl::PCLPointField& field : cloud.fields) {
        const bool is_float = field.datatype == pcl::PCLPointField::FLOAT32;
        const std::size_t end =
            field.offset + (is_float ? sizeof(float) : sizeof(double));
        if (field.name != name || field.count > 1 || !(is_float || isDouble(field)) ||
            end > cloud.point_step)
          continue;
        fields_.push_back(field);
        break;
      }
  }

  /** \brief Whether all three fields are there, as single floating-point numbers. */
  bool
  isComplete() const
  {
    return fields_.size() == 3;
  }

  /** \brief Whether all three are of 64 bits. */
  bool
  areDoubles() const
  {
    return std::all_of(fields_.begin(), fields_.end(), isDouble);
  }

  /** \brief The vector of point \p index. */
  Eigen::Vector3d
  get(const pcl::PCLPointCloud2& cloud, std::size_t index) const
  {
    Eigen::Vector3d vector;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto* place = &cloud.data[index * cloud.point_step + fields_[k].offset];
      const auto read = [place](auto number) {
        std::memcpy(&number, place, sizeof(number));
        return double(number);
      };
      vector[static_cast<Eigen::Index>(k)] =
          isDouble(fields_[k]) ? read(0.0) : read(0.0F);
    }
    return vector;
  }

  /** \brief Change the vector of point \p index. */
  void
  set(pcl::PCLPointCloud2& cloud,
      std::size_t index,
      const Eigen::Vector3d& vector) const
  {
    for (std::size_t k = 0; k < 3; ++k) {
      auto* place = &cloud.data[index * cloud.point_step + fields_[k].offset];
      const double number = vector[static_cast<Eigen::Index>(k)];
      const auto write = [place](auto value) {
        std::memcpy(place, &value, sizeof(value));
      };
      isDouble(fields_[k]) ? write(number) : write(static_cast<float>(number));
    }
  }

private:
  static bool
  isDouble(const pcl::PCLPointField& field)
  {
    return field.datatype == pcl::PCLPointField::FLOAT64;
  }

  std::vector<pcl::PCLPointField> fields_;
};

} // namespace bayesian_icp::io
