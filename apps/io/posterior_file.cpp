#include "io/posterior_file.h"

#include "io/coordinates.h"
#include "io/errors.h"
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/numbers.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp::io {

using nlohmann::json;

namespace {

constexpr std::uint64_t max_posterior_size = 16 << 20;
constexpr std::uint64_t max_samples_size = 1 << 30;
constexpr std::size_t num_samples_columns = 8;

/** A value of the file and the way to it, for errors. */
class Node {
public:
  Node(const std::string& file, const json& value) : file_(file), value_(value) {}

  Node
  operator[](const std::string& key) const
  {
    const std::string path = path_ + (path_.empty() ? "" : ".") + key;
    if (!value_.is_object())
      refuse("an object");
    if (!value_.contains(key))
      throw FileError(file_, "the key '" + path + "' is missing");
    return {file_, value_[key], path};
  }

  Node
  operator[](Eigen::Index index) const
  {
    return {file_,
            value_[static_cast<std::size_t>(index)],
            path_ + '[' + textOf(index) + ']'};
  }

  void
  requireList(Eigen::Index size) const
  {
    if (!value_.is_array() || value_.size() != static_cast<std::size_t>(size))
      refuse("a list of " + textOf(size));
  }

  std::string
  text() const
  {
    if (!value_.is_string())
      refuse("a text");
    return value_.get<std::string>();
  }

  /** null is what JSON has for NaN. */
  double
  number() const
  {
    if (value_.is_null())
      return std::numeric_limits<double>::quiet_NaN();
    if (!value_.is_number())
      refuse("a number or null");
    return value_.get<double>();
  }

  template <typename Matrix>
  Matrix
  matrix() const
  {
    Matrix result;
    requireList(result.rows());
    for (Eigen::Index row = 0; row < result.rows(); ++row) {
      (*this)[row].requireList(result.cols());
      for (Eigen::Index column = 0; column < result.cols(); ++column)
        result(row, column) = (*this)[row][column].number();
    }
    return result;
  }

  [[noreturn]] void
  refuse(const std::string& expected) const
  {
    throw FileError(file_,
                    (path_.empty() ? "the document" : path_) + " is not " + expected);
  }

private:
  Node(const std::string& file, const json& value, std::string path)
  : file_(file)
  , value_(value)
  , path_(std::move(path))
  {}

  const std::string& file_;
  const json& value_;
  std::string path_;
};

void
checkSchema(const std::string& name, const json& document)
{
  if (!document.is_object() || !document.contains("schema") ||
      document["schema"] != posterior_schema_name)
    throw FileError(name, "is no posterior.json: its 'schema' is another");
  if (!document.contains("schema_version") ||
      document["schema_version"] != posterior_schema_version)
    throw FileError(name,
                    "is a posterior.json of another 'schema_version' than " +
                        textOf(posterior_schema_version));
}

Vector6d
meanOf(const Node& mean)
{
  Vector6d pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[static_cast<Eigen::Index>(k)] = mean[app::coordinateKey(k)].number();
  return pose;
}

std::array<Matrix6d, 4>
covariancesOf(const Node& list)
{
  std::array<Matrix6d, 4> covariances;
  list.requireList(4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const char* convention = toString(static_cast<CovarianceConvention>(i));
    if (list[i]["convention"].text() != convention)
      list[i]["convention"].refuse(std::string("'") + convention + '\'');
    covariances[static_cast<std::size_t>(i)] = list[i]["matrix"].matrix<Matrix6d>();
  }
  return covariances;
}

/** The pose of a line of samples.csv, behind its two indices.
 * \return whether the line is a good one */
bool
readPose(const std::string& line, double* pose)
{
  const auto cells = splitAt(',', line);
  std::size_t index = 0;
  if (cells.size() != num_samples_columns || !readNumber(cells[0], index) ||
      !readNumber(cells[1], index))
    return false;
  for (std::size_t k = 0; k < 6; ++k)
    if (!readNumber(cells[k + 2], pose[k]) || !std::isfinite(pose[k]))
      return false;
  return true;
}

bool
readLineOf(InputFile& file, std::string& line)
{
  if (!file.readLine(line))
    return false;
  if (!line.empty() && line.back() == '\r')
    line.pop_back();
  return true;
}

} // namespace

PosteriorFile
readPosterior(const std::string& name)
{
  const json document = readJson(name, max_posterior_size);
  checkSchema(name, document);
  const Node root(name, document);
  PosteriorFile posterior;
  posterior.source_file = root["source"]["file"].text();
  posterior.target_file = root["target"]["file"].text();
  posterior.status = root["status"]["name"].text();
  posterior.status_message = root["status"]["message"].text();
  posterior.guess =
      root["options"]["registration"]["guess_matrix"].matrix<Eigen::Matrix4d>();
  posterior.final_matrix =
      root["final_transformation"]["T_target_source"].matrix<Eigen::Matrix4d>();
  posterior.mean = meanOf(root["posterior"]["mean"]);
  posterior.covariances = covariancesOf(root["posterior"]["covariances"]);
  return posterior;
}

PoseMatrix
readSamples(const std::string& name)
{
  InputFile file = openInput(name);
  if (file.size > max_samples_size)
    throw FileError(name, "is too large (" + std::to_string(file.size) + " bytes)");
  std::string line;
  if (!readLineOf(file, line) || line != samples_header)
    throw FileError(name,
                    std::string("its first line is not '") + samples_header + "'");
  std::vector<double> numbers;
  double pose[6];
  for (std::size_t line_number = 2; file.numBytesLeft() > 0; ++line_number) {
    if (!readLineOf(file, line) || !readPose(line, pose))
      throw FileError(name,
                      "line " + textOf(line_number) +
                          " is not two indices and six finite numbers");
    numbers.insert(numbers.end(), pose, pose + 6);
  }
  if (numbers.empty())
    throw FileError(name, "has no draws");
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;
  return Eigen::Map<const Rows>(
      numbers.data(), static_cast<Eigen::Index>(numbers.size() / 6), 6);
}

} // namespace bayesian_icp::io
