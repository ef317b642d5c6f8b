/** \file
 * \brief Internal: new and delete of the registration classes of this library.
 */
#pragma once

#include <pcl/registration/icp.h>

#include <Eigen/Core>

#include <cstddef>
#include <new>

namespace pcl {
namespace bayesian_icp_detail {

/** ICP whose new and delete are Eigen's aligned ones in every standard of C++. Those of
 * PCL's classes are so in C++14 only: an object that a program in C++14 has made would
 * be deleted by the library, which is C++17, in another way, or not even be linked. */
template <typename PointSource, typename PointTarget, typename Scalar>
class AlignedIterativeClosestPoint
: public IterativeClosestPoint<PointSource, PointTarget, Scalar> {
public:
  static void*
  operator new(std::size_t size)
  {
    return (Eigen::internal::aligned_malloc(size));
  }

  static void*
  operator new[](std::size_t size)
  {
    return (Eigen::internal::aligned_malloc(size));
  }

  static void*
  operator new(std::size_t /* size */, void* place) noexcept
  {
    return (place);
  }

  static void
  operator delete(void* object) noexcept
  {
    Eigen::internal::aligned_free(object);
  }

  static void
  operator delete[](void* objects) noexcept
  {
    Eigen::internal::aligned_free(objects);
  }

  static void
  operator delete(void* /* object */, void* /* place */) noexcept
  {}
};

} // namespace bayesian_icp_detail
} // namespace pcl
