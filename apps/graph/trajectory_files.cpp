#include "graph/trajectory_files.h"

#include "io/errors.h"
#include "io/input_file.h"
#include "io/numbers.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/measurement.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <stdexcept>

namespace bayesian_icp::app {

namespace {

PoseEstimate
estimateOf(const GaussianPose& pose)
{
  PoseEstimate estimate = bayesian_icp::estimateOf(
      pose.mean, pose.covariance, CovarianceConvention::RightSE3);
  estimate.status = Status::Ok;
  return estimate;
}

template <typename LineOf>
std::string
linesOf(const std::vector<std::int64_t>& times,
        const std::vector<GaussianPose>& poses,
        const LineOf& lineOf)
{
  std::string text;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    ExportOptions options;
    options.timestamp_ns = times.at(k);
    text += lineOf(estimateOf(poses[k]), options);
  }
  return text;
}

/** \param[in] numbers position, and quaternion x y z w */
Eigen::Matrix4d
transformOf(const double* numbers)
{
  constexpr double tolerance = 1e-2; // of the quaternion's length
  const Eigen::Map<const Eigen::Vector3d> position(numbers);
  const Eigen::Quaterniond rotation(numbers + 3);
  if (!(std::abs(rotation.norm() - 1.0) < tolerance) || !position.allFinite())
    throw std::runtime_error("has an invalid pose");
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = rotation.normalized().toRotationMatrix();
  T.topRightCorner<3, 1>() = position;
  return T;
}

/** \param[in] numbers the upper triangle of the information, row by row */
Matrix6d
covarianceOf(const double* numbers)
{
  Matrix6d information;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      information(row, column) = information(column, row) = *numbers++;
  const Eigen::LLT<Matrix6d> factor(information);
  const Matrix6d of_half_angles = factor.solve(Matrix6d::Identity());
  if (factor.info() != Eigen::Success || !of_half_angles.allFinite())
    throw std::runtime_error("has an information matrix that is not positive definite");
  const Vector6d scale(1.0, 1.0, 1.0, 2.0, 2.0, 2.0);
  return scale.asDiagonal() * of_half_angles * scale.asDiagonal();
}

/** Of the words of a line: tag, two vertices, pose, information. */
GraphEdge
edgeOf(const std::vector<std::string_view>& words)
{
  constexpr std::size_t num_names = 3, size_of_pose = 7, size_of_information = 21;
  std::array<double, size_of_pose + size_of_information> numbers;
  GraphEdge edge;
  bool is_edge = words.size() == num_names + numbers.size() &&
                 io::readNumber(words[1], edge.target) &&
                 io::readNumber(words[2], edge.source) && edge.target != edge.source;
  for (std::size_t k = 0; k < numbers.size() && is_edge; ++k)
    is_edge = io::readNumber(words[num_names + k], numbers[k]);
  if (!is_edge)
    throw std::runtime_error("is not an edge with two different vertices, 7 numbers of "
                             "its pose and 21 of its information");
  edge.T_target_source = transformOf(numbers.data());
  edge.covariance = covarianceOf(numbers.data() + size_of_pose);
  return edge;
}

} // namespace

std::string
tumText(const std::vector<std::int64_t>& times, const std::vector<GaussianPose>& poses)
{
  return linesOf(times, poses, tumLine);
}

std::string
tumCovarianceText(const std::vector<std::int64_t>& times,
                  const std::vector<GaussianPose>& poses)
{
  return linesOf(times, poses, tumCovarianceLine);
}

std::string
g2oText(const std::vector<GaussianPose>& poses, const std::vector<GraphEdge>& edges)
{
  std::string text;
  for (std::size_t k = 0; k < poses.size(); ++k)
    text += g2oVertex(matrixOf(poses[k].mean), static_cast<int>(k));
  text += "FIX 0\n";
  for (const GraphEdge& edge : edges) {
    ExportOptions options;
    options.target_vertex = edge.target;
    options.source_vertex = edge.source;
    const GaussianPose pose{poseOf(edge.T_target_source),
                            invertibleCovariance(edge.covariance)};
    text += g2oEdge(estimateOf(pose), options);
  }
  return text;
}

std::vector<GraphEdge>
readGraph(const std::string& file)
{
  constexpr std::uint64_t max_size = 1'000'000'000;
  const std::string edge_tag = "EDGE_SE3:QUAT";
  const std::string text = io::readText(file, max_size);
  std::vector<GraphEdge> edges;
  int line_number = 0;
  for (const std::string_view line : io::splitAt('\n', text)) {
    ++line_number;
    const std::vector<std::string_view> words = io::words(line);
    if (words.empty() || words[0] != edge_tag)
      continue;
    try {
      edges.push_back(edgeOf(words));
    }
    catch (const std::runtime_error& error) {
      throw io::FileError(file, "line " + io::textOf(line_number) + ' ' + error.what());
    }
  }
  if (edges.empty())
    throw io::FileError(file, "has no " + edge_tag);
  return edges;
}

Matrix6d
invertibleCovariance(const Matrix6d& covariance)
{
  constexpr double widening = 1e-10; // least eigenvalue of correlations
  const PoseEstimate estimate = estimateOf({Vector6d::Zero(), covariance});
  Matrix6d wider = covariance;
  if (!complaintAboutExport(estimate, true).empty())
    wider.diagonal() *= 1.0 + 2.0 * widening;
  return wider;
}

} // namespace bayesian_icp::app
