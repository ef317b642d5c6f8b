#include "trajectories/trajectory_run.h"

#include "algebra/decompositions.h"
#include "graph/closed_cycles.h"

#include <Eigen/SVD>

#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace bayesian_icp::evaluate {

using app::GraphEdge;
using Eigen::Index;
using Eigen::Isometry3d;

namespace {

double
angleOf(const Isometry3d& motion)
{
  return Eigen::AngleAxisd(motion.linear()).angle();
}

double
absoluteError(const std::vector<Isometry3d>& estimate,
              const std::vector<Isometry3d>& truth)
{
  const auto size = static_cast<Index>(truth.size());
  Eigen::Matrix3Xd from(3, size), to(3, size);
  for (Index k = 0; k < size; ++k) {
    from.col(k) = estimate[static_cast<std::size_t>(k)].translation();
    to.col(k) = truth[static_cast<std::size_t>(k)].translation();
  }
  const Isometry3d align(Eigen::umeyama(from, to, false));
  return std::sqrt((align * from - to).colwise().squaredNorm().mean());
}

double
normalizedSquaredError(const app::GaussianPose& estimate,
                       const Isometry3d& truth,
                       const Matrix6d& truth_covariance)
{
  const Vector6d error =
      logSE3(Isometry3d(matrixOf(estimate.mean)).inverse().matrix() * truth.matrix());
  return error.dot((estimate.covariance + truth_covariance).ldlt().solve(error)) / 6.0;
}

constexpr const char* constant = "constant";
constexpr std::size_t max_cycle_length = 4;

using Pair = std::pair<int, int>;

/** The edges that a method has. */
std::map<Pair, GraphEdge>
edgesOf(const RegisteredRecording& registered, const std::string& method)
{
  std::map<Pair, GraphEdge> edges;
  for (const EdgeRun& run : registered.edges)
    if (run.name.method == method && run.complaint.empty())
      edges[{run.name.target, run.name.source}] = graphEdgeOf(run);
  return edges;
}

Matrix6d
covarianceOf(const AxisDeviation& deviation)
{
  return deviation.vector().cwiseAbs2().asDiagonal();
}

/** Whether a constant covariance for \p judged may be fitted to \p other. */
bool
isFittedTo(const RegisteredRecording& other, const RegisteredRecording& judged)
{
  const bool is_simulated = judged.recording.quality == "exact";
  return other.recording.name != judged.recording.name &&
         (other.recording.quality == "exact") == is_simulated &&
         other.recording.quality != "C";
}

/** Of the errors of the edges of \p means in other recordings; nothing without any. */
std::optional<Matrix6d>
constantCovariance(const std::vector<RegisteredRecording>& recordings,
                   const RegisteredRecording& judged,
                   const std::string& means)
{
  double translations = 0.0, rotations = 0.0, count = 0.0;
  for (const RegisteredRecording& other : recordings) {
    if (!isFittedTo(other, judged))
      continue;
    for (const auto& [pair, edge] : edgesOf(other, means)) {
      const Isometry3d truth = other.recording.relativePose(
          static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second));
      const Vector6d error =
          logSE3(Isometry3d(edge.T_target_source).inverse().matrix() * truth.matrix());
      translations += error.head<3>().squaredNorm() / 3.0;
      rotations += error.tail<3>().squaredNorm() / 3.0;
      count += 1.0;
    }
  }
  if (count == 0.0)
    return std::nullopt;
  return covarianceOf({std::sqrt(translations / count), std::sqrt(rotations / count)});
}

/** Edges with the means of one method and the covariances of another; what either does
 * not have is left out. */
std::vector<GraphEdge>
combinedEdges(const RegisteredRecording& registered,
              const std::string& means,
              const std::string& covariances,
              const Matrix6d& constant_covariance)
{
  const std::map<Pair, GraphEdge> from = edgesOf(registered, covariances);
  std::vector<GraphEdge> edges;
  for (auto [pair, edge] : edgesOf(registered, means)) {
    if (covariances == constant)
      edge.covariance = constant_covariance;
    else if (from.count(pair) > 0)
      edge.covariance = from.at(pair).covariance;
    else
      continue;
    edges.push_back(edge);
  }
  return edges;
}

/** The guesses of each scan's pose in the one before it. */
std::vector<GraphEdge>
odometryOf(const RegisteredRecording& registered)
{
  std::vector<GraphEdge> edges;
  for (int source = 1; source < static_cast<int>(registered.recording.poses.size());
       ++source)
    edges.push_back(
        {source - 1,
         source,
         guessOf(registered.recording, registered.seed, source - 1, source).matrix(),
         covarianceOf(guess_sd),
         app::independent_noise});
  return edges;
}

/** Poses along the edges from each scan to the one before it, of several the last. */
std::vector<Eigen::Matrix4d>
chained(const std::vector<GraphEdge>& edges, std::size_t num_scans)
{
  std::vector<Eigen::Matrix4d> steps(num_scans, Eigen::Matrix4d::Identity());
  for (const GraphEdge& edge : edges)
    if (edge.source == edge.target + 1)
      steps[static_cast<std::size_t>(edge.source)] = edge.T_target_source;
  for (std::size_t k = 1; k < num_scans; ++k)
    steps[k] = steps[k - 1] * steps[k];
  return steps;
}

void
scoreCycles(const std::vector<GraphEdge>& edges, TrajectoryRun& run)
{
  const std::vector<app::CycleStatistics> lines =
      app::statisticsOf(app::closedCycles(edges, max_cycle_length));
  run.num_cycles = lines.empty() ? 0 : static_cast<int>(lines.back().num_cycles);
  run.cycle_nees_per_degree =
      lines.empty() ? std::nan("") : lines.back().nees_per_degree;
}

TrajectoryRun
trajectoryOf(const RegisteredRecording& registered,
             const std::string& means,
             const std::string& covariances,
             const Matrix6d& constant_covariance)
{
  const Recording& recording = registered.recording;
  TrajectoryRun run;
  run.recording = recording.name;
  run.quality = recording.quality;
  run.seed = registered.seed;
  run.means = means;
  run.covariances = covariances;
  run.num_scans = static_cast<int>(recording.poses.size());
  std::vector<GraphEdge> edges =
      combinedEdges(registered, means, covariances, constant_covariance);
  scoreCycles(edges, run);
  run.num_edges = static_cast<int>(edges.size());
  const std::vector<GraphEdge> odometry = odometryOf(registered);
  edges.insert(edges.begin(), odometry.begin(), odometry.end());
  const app::OptimizedPoses optimized = app::optimizedPoses(
      chained(edges, recording.poses.size()), edges, app::RobustLoss::None);
  run.score = scoreOf(optimized.poses, recording.poses, recording.truth_sd);
  if (!optimized.complaint.empty() || recording.quality == "C")
    run.score.nees_per_degree = run.score.nees_per_degree_of_last = std::nan("");
  return run;
}

} // namespace

TrajectoryScore
scoreOf(const std::vector<app::GaussianPose>& estimate,
        const std::vector<Isometry3d>& truth,
        const AxisDeviation& truth_sd)
{
  std::vector<Isometry3d> poses, true_poses;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    poses.emplace_back(matrixOf(estimate.at(k).mean));
    true_poses.push_back(truth[0].inverse() * truth[k]);
  }
  TrajectoryScore score;
  score.ate = absoluteError(poses, true_poses);
  const auto num_steps = static_cast<double>(truth.size() - 1);
  double translations = 0.0, rotations = 0.0;
  for (std::size_t k = 1; k < truth.size(); ++k) {
    const Isometry3d error = (true_poses[k - 1].inverse() * true_poses[k]).inverse() *
                             (poses[k - 1].inverse() * poses[k]);
    translations += error.translation().squaredNorm();
    rotations += std::pow(angleOf(error), 2);
    score.nees_per_degree_of_last =
        normalizedSquaredError(estimate[k], true_poses[k], covarianceOf(truth_sd));
    score.nees_per_degree += score.nees_per_degree_of_last / num_steps;
  }
  score.rpe_translation = std::sqrt(translations / num_steps);
  score.rpe_rotation = std::sqrt(rotations / num_steps);
  const Isometry3d last_error = true_poses.back().inverse() * poses.back();
  score.drift_translation = last_error.translation().norm();
  score.drift_rotation = angleOf(last_error);
  return score;
}

std::vector<TrajectoryRun>
trajectoriesOf(const std::vector<RegisteredRecording>& recordings)
{
  static const std::vector<std::pair<std::string, std::string>> combinations = {
      {"calibrated", "calibrated"},
      {"calibrated", constant},
      {"calibrated", "gicp"},
      {"calibrated", "closed-form"},
      {"gicp", constant},
      {"gicp", "gicp"},
      {"closed-form", "closed-form"}};
  std::vector<TrajectoryRun> runs;
  for (const RegisteredRecording& registered : recordings)
    for (const auto& [means, covariances] : combinations) {
      const std::optional<Matrix6d> fitted =
          covariances == constant ? constantCovariance(recordings, registered, means)
                                  : Matrix6d::Identity();
      if (fitted)
        runs.push_back(trajectoryOf(registered, means, covariances, *fitted));
    }
  return runs;
}

} // namespace bayesian_icp::evaluate
