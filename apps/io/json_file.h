/** \file
 * \brief Reading JSON that others have written and that may be broken or hostile, with
 * errors that say where it is wrong.
 */
#pragma once

#include "io/errors.h"

#include <Eigen/Core>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <set>
#include <string>

namespace bayesian_icp::io {

/** \brief Deepest nesting of a JSON file that is read: what handles a value later may
 * call itself for each level. */
constexpr int max_json_depth = 64;

/** \brief Parse a JSON file of at most \p max_size bytes.
 * \throws FileError if it cannot be read, or what is wrong with its JSON */
nlohmann::json
readJson(const std::string& name, std::uint64_t max_size);

/** \brief A node of a document and the way to it: "covariances[1].matrix". What reads
 * it throws a UsageError that names the way if the node is another one. */
class JsonNode {
public:
  /** \param[in] value has to outlive this
   *  \param[in] path empty for the whole document */
  explicit JsonNode(const nlohmann::json& value, const std::string& path = "")
  : value_(value)
  , path_(path)
  {}

  const nlohmann::json&
  json() const
  {
    return value_;
  }

  /** \brief Whether this is an object with that key. */
  bool
  has(const std::string& key) const
  {
    return value_.is_object() && value_.contains(key);
  }

  JsonNode
  operator[](const std::string& key) const
  {
    const std::string path = pathOf(key);
    requireObject();
    if (!has(key))
      throw UsageError("the key '" + path + "' is missing");
    return JsonNode(value_[key], path);
  }

  JsonNode
  operator[](std::size_t index) const
  {
    return JsonNode(value_[index], path_ + '[' + std::to_string(index) + ']');
  }

  void
  requireObject() const
  {
    if (!value_.is_object())
      refuse("an object");
  }

  /** \brief Require an object that has no other keys than \p known. */
  void
  requireKeysAmong(const std::set<std::string>& known) const
  {
    requireObject();
    for (const auto& item : value_.items())
      if (known.count(item.key()) == 0)
        throw UsageError("unknown key " + inQuotes(pathOf(item.key())));
  }

  void
  requireList(Eigen::Index size) const
  {
    if (!value_.is_array() || value_.size() != static_cast<std::size_t>(size))
      refuse("a list of " + std::to_string(size));
  }

  std::string
  text() const
  {
    if (!value_.is_string())
      refuse("a text");
    return value_.get<std::string>();
  }

  double
  number() const
  {
    if (!value_.is_number())
      refuse("a number");
    return value_.get<double>();
  }

  /** \brief A number, or null, which is what JSON has for those that are not finite. */
  double
  numberOr(double null_value) const
  {
    return value_.is_null() ? null_value : number();
  }

  /** \brief A matrix as the list of its rows, a vector as a list; null is NaN. */
  template <typename Matrix>
  Matrix
  matrix() const
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    Matrix result;
    requireList(result.rows());
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
      const JsonNode row = (*this)[static_cast<std::size_t>(i)];
      if constexpr (Matrix::ColsAtCompileTime == 1)
        result(i) = row.numberOr(nan);
      else
        result.row(i) =
            row.matrix<Eigen::Matrix<double, Matrix::ColsAtCompileTime, 1>>();
    }
    return result;
  }

  /** \brief Say that the value is another one. */
  [[noreturn]] void
  refuse(const std::string& expected) const
  {
    throw UsageError(path_ + (path_.empty() ? "is " : " is ") +
                     inQuotes(value_.dump()) + ", but must be " + expected);
  }

private:
  std::string
  pathOf(const std::string& key) const
  {
    return path_.empty() ? key : path_ + '.' + key;
  }

  const nlohmann::json& value_;
  std::string path_;
};

} // namespace bayesian_icp::io
