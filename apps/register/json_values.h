/** \file
 * \brief Numbers, matrices and settings to JSON, which has no infinity and no NaN: they
 * are null.
 */
#pragma once

#include "register/field.h"

#include <bayesian_icp/options.h>

#include <nlohmann/json.hpp>

#include <type_traits>

namespace bayesian_icp::app {

/** \brief A vector as a list, a matrix as a list of its rows. */
template <typename Derived>
nlohmann::ordered_json
jsonOf(const Eigen::MatrixBase<Derived>& matrix)
{
  auto list = nlohmann::ordered_json::array();
  if constexpr (Derived::ColsAtCompileTime == 1)
    for (Eigen::Index i = 0; i < matrix.size(); ++i)
      list.push_back(double(matrix(i, 0)));
  else
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      list.push_back(jsonOf(matrix.row(i).transpose().eval()));
  return list;
}

/** \brief The list of what \p toJson makes of each of \p items. */
template <typename Items, typename ToJson>
nlohmann::ordered_json
listOf(const Items& items, const ToJson& toJson)
{
  auto list = nlohmann::ordered_json::array();
  for (const auto& item : items)
    list.push_back(toJson(item));
  return list;
}

/** \brief As text. Names of files need not be UTF-8; what is not becomes U+FFFD.
 * \param[in] indent number of blanks; -1: all in one line */
inline std::string
jsonText(const nlohmann::ordered_json& value, int indent = -1)
{
  return value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

/** \brief A visitor that writes the fields of a table of settings in their groups. */
struct FieldWriter {
  nlohmann::ordered_json document = nlohmann::ordered_json::object();

  template <typename T>
  void
  operator()(const Field& field, const T& value)
  {
    nlohmann::ordered_json& place = document[field.group][field.key];
    if constexpr (std::is_enum_v<T>)
      place = toString(value);
    else if constexpr (std::is_arithmetic_v<T>)
      place = value;
    else
      place = jsonOf(value);
  }

  /** The prior mean that is not given is null as a whole. */
  void
  operator()(const Field& field, const Vector6d& value)
  {
    const bool is_given = !value.array().isNaN().all();
    document[field.group][field.key] = is_given ? jsonOf(value) : nullptr;
  }

  template <typename T>
  void
  operator()(const Field& field, const Automatic<T>& value)
  {
    if (value.isGiven())
      (*this)(field, value.valueOr(T()));
    else
      document[field.group][field.key] = "automatic";
  }
};

} // namespace bayesian_icp::app
