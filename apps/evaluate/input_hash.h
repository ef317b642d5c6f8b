/** \file
 * \brief A number for the inputs of a result that is kept on disk, so that it is never
 * used for others.
 */
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace bayesian_icp::evaluate {

/** \brief FNV-1a, 64 bits, of what is added, in its order. */
class InputHash {
public:
  void
  add(const void* data, std::size_t size)
  {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i)
      value_ = (value_ ^ bytes[i]) * 0x100000001b3u;
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
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

} // namespace bayesian_icp::evaluate
