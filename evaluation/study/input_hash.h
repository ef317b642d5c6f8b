/** \file
 * \brief A number for the inputs of a result that is kept on disk, so that it is never
 * used for others.
 */
#pragma once

#include "io/text_hash.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace bayesian_icp::evaluate {

/** \brief io::hashOf() what is added, in its order. */
class InputHash {
public:
  void
  add(const void* data, std::size_t size)
  {
    value_ = io::hashOf({static_cast<const char*>(data), size}, value_);
  }

  void
  add(double number)
  {
    add(&number, sizeof number);
  }

  template <typename Derived>
  void
  addMatrix(const Eigen::PlainObjectBase<Derived>& matrix)
  {
    add(matrix.data(),
        sizeof(typename Derived::Scalar) * static_cast<std::size_t>(matrix.size()));
  }

  std::uint64_t
  value() const
  {
    return value_;
  }

private:
  std::uint64_t value_ = io::hash_of_nothing;
};

} // namespace bayesian_icp::evaluate
