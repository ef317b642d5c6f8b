/** \file
 * \brief Internal: what is inside a PreparedCloud.
 */
#pragma once

#include "calibrated/surface/prepared_surface.h"
#include "calibrated/surface/relative_size.h"

#include <bayesian_icp/kd_tree.h>

#include <array>
#include <mutex>
#include <optional>
#include <utility>

namespace bayesian_icp {

/** \brief A value that is made when it is first asked for, by one thread. If making it
 * throws, the next one that asks tries again. */
template <typename T>
class Lazy {
public:
  /** \param[in] make returns the value */
  template <typename Make>
  const T&
  get(const Make& make)
  {
    std::call_once(is_made_, [&] { value_.emplace(make()); });
    return *value_;
  }

private:
  std::once_flag is_made_;
  std::optional<T> value_;
};

/** \brief The points of a cloud and what is made of them. */
struct CloudParts {
  explicit CloudParts(Eigen::Matrix3Xd cloud_points) : points(std::move(cloud_points))
  {}

  /** The surface to which \p other is registered.
   * \param[in] num_threads 0: as OpenMP would */
  const PreparedSurface&
  surfaceFor(const CloudParts& other, int num_threads)
  {
    const int num_doublings = numDoublings(points, other.points);
    return surfaces_[static_cast<std::size_t>(num_doublings)].get(
        [&] { return prepareSurface(points, num_threads, num_doublings); });
  }

  /** In single precision. */
  const KdTree&
  tree(int num_threads)
  {
    return tree_.get([&] { return KdTree(points.cast<float>(), num_threads); });
  }

  const Eigen::Matrix3Xd points;

private:
  /** By the number of doublings of their patches. */
  std::array<Lazy<PreparedSurface>, max_doublings + 1> surfaces_;
  Lazy<KdTree> tree_;
};

} // namespace bayesian_icp
