/** \file
 * \brief Three fields of a PCLPointCloud2 as one vector, of 32 or 64 bits alike.
 */
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <Eigen/Core>

#include <array>
#include <cstring>

namespace bayesian_icp::io {

/** \brief Where x, y, z (or the like) are within a point of a cloud. */
class FieldTriple {
public:
  /** \brief Whether all three fields are there, as single floating-point numbers. */
  bool
  isComplete() const
  {
    return num_found_ == fields_.size();
  }

  /** \brief The vector of point \p index. */
  Eigen::Vector3d
  get(const pcl::PCLPointCloud2& cloud, std::size_t index) const
  {
    Eigen::Vector3d vector;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      const auto* place = &cloud.data[index * cloud.point_step + fields_[k].offset];
      vector[static_cast<Eigen::Index>(k)] =
          fields_[k].is_double ? read<double>(place) : read<float>(place);
    }
    return vector;
  }

  /** \brief Change the vector of point \p index. */
  void
  set(pcl::PCLPointCloud2& cloud,
      std::size_t index,
      const Eigen::Vector3d& vector) const
  {
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      auto* place = &cloud.data[index * cloud.point_step + fields_[k].offset];
      const double value = vector[static_cast<Eigen::Index>(k)];
      if (fields_[k].is_double)
        std::memcpy(place, &value, sizeof(double));
      else
        write(place, static_cast<float>(value));
    }
  }

private:
  friend FieldTriple
  findFields(const pcl::PCLPointCloud2& cloud, const std::array<const char*, 3>& names);

  struct Field {
    std::size_t offset;
    bool is_double;
  };

  template <typename Number>
  static double
  read(const void* place)
  {
    Number value;
    std::memcpy(&value, place, sizeof(Number));
    return static_cast<double>(value);
  }

  static void
  write(void* place, float value)
  {
    std::memcpy(place, &value, sizeof(float));
  }

  std::array<Field, 3> fields_{};
  std::size_t num_found_ = 0;
};

/** \brief Look for three fields by name; each is taken where it comes first. */
inline FieldTriple
findFields(const pcl::PCLPointCloud2& cloud, const std::array<const char*, 3>& names)
{
  FieldTriple triple;
  for (std::size_t k = 0; k < names.size(); ++k)
    for (const auto& field : cloud.fields) {
      const bool is_double = field.datatype == pcl::PCLPointField::FLOAT64;
      const bool is_float = is_double || field.datatype == pcl::PCLPointField::FLOAT32;
      const std::size_t size = is_double ? sizeof(double) : sizeof(float);
      if (field.name != names[k] || !is_float || field.count != 1 ||
          field.offset + size > cloud.point_step)
        continue;
      triple.fields_[k] = {field.offset, is_double};
      ++triple.num_found_;
      break;
    }
  return triple;
}

} // namespace bayesian_icp::io
