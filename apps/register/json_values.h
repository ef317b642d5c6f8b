/** \file
 * \brief Numbers and matrices to JSON (which has no infinity and no NaN: they are
 * null), and how messages name a key.
 */
#pragma once

#include "io/errors.h"

#include <Eigen/Core>

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

namespace bayesian_icp::app {

/** \brief "group.key". */
inline std::string
keyPath(std::string group, const std::string& key)
{
  group += '.';
  group += key;
  return group;
}

/** \brief Refuse the value at \p path ("group.key").
 * \throws io::UsageError */
[[noreturn]] inline void
refuse(const std::string& path,
       const nlohmann::json& value,
       const std::string& expected)
{
  throw io::UsageError(path + " is " + io::inQuotes(value.dump()) + ", but must be " +
                       expected);
}

inline nlohmann::ordered_json
jsonOf(double number)
{
  return std::isfinite(number) ? nlohmann::ordered_json(number)
                               : nlohmann::ordered_json(nullptr);
}

/** \brief A vector as a list, a matrix as a list of its rows. */
template <typename Derived>
nlohmann::ordered_json
jsonOf(const Eigen::MatrixBase<Derived>& matrix)
{
  auto list = nlohmann::ordered_json::array();
  if constexpr (Derived::ColsAtCompileTime == 1)
    for (Eigen::Index i = 0; i < matrix.size(); ++i)
      list.push_back(jsonOf(double(matrix(i, 0))));
  else
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      list.push_back(jsonOf(matrix.row(i).transpose().eval()));
  return list;
}

} // namespace bayesian_icp::app
