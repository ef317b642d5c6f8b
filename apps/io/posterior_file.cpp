#include "io/posterior_file.h"

#include "io/coordinates.h"
#include "io/errors.h"
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/numbers.h"

#include <cmath>
#include <vector>

namespace bayesian_icp::io {

using nlohmann::json;

namespace {

constexpr std::uint64_t max_posterior_size = 16 << 20;
constexpr std::uint64_t max_samples_size = 1 << 30;
constexpr std::size_t num_samples_columns = 8;

void
checkSchema(const std::string& name, const json& document)
{
  if (!document.is_object() || !document.contains("schema") ||
      document["schema"] != posterior_schema_name)
    throw FileError(name, "is not a posterior.json: its 'schema' is different");
  if (!document.contains("schema_version") ||
      document["schema_version"] != posterior_schema_version)
    throw FileError(name,
                    "is a posterior.json whose 'schema_version' is not " +
                        textOf(posterior_schema_version));
}

Eigen::Index
countOf(const JsonNode& count)
{
  if (!count.json().is_number_unsigned())
    count.refuse("a whole number from 0 on");
  return count.json().get<Eigen::Index>();
}

Vector6d
meanOf(const JsonNode& mean)
{
  Vector6d pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[static_cast<Eigen::Index>(k)] =
        mean[app::coordinateKey(k)].numberOr(std::nan(""));
  return pose;
}

std::array<Matrix6d, 4>
covariancesOf(const JsonNode& list)
{
  std::array<Matrix6d, 4> covariances;
  list.requireList(4);
  for (std::size_t i = 0; i < 4; ++i) {
    const char* convention = toString(static_cast<CovarianceConvention>(i));
    if (list[i]["convention"].text() != convention)
      list[i]["convention"].refuse(convention);
    covariances[i] = list[i]["matrix"].matrix<Matrix6d>();
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
try {
  const json document = readJson(name, max_posterior_size);
  checkSchema(name, document);
  const JsonNode root(document);
  PosteriorFile posterior;
  posterior.source_file = root["source"]["file"].text();
  posterior.target_file = root["target"]["file"].text();
  posterior.num_source_points = countOf(root["source"]["points"]);
  posterior.num_target_points = countOf(root["target"]["points"]);
  posterior.num_draws = countOf(root["posterior"]["draws"]);
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
catch (const UsageError& error) {
  throw FileError(name, error.what());
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
