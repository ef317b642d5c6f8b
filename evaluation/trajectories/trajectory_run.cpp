#include "trajectories/trajectory_run.h"

#include "graph/cycle_closure.h"
#include "graph/optimization.h"

#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

namespace bayesian_icp::evaluate {

using app::GraphEdge;
using Eigen::Isometry3d;

namespace {

constexpr const char* constant = "constant";
constexpr std::size_t max_cycle_length = 4;
/** Of an edge that has to be guessed, each axis [m, rad]. */
constexpr AxisDeviation guess_sd = {0.1, 0.03};

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
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(std::pow(deviation.translation, 2)),
      Eigen::Vector3d::Constant(std::pow(deviation.rotation, 2));
  return variances.asDiagonal();
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

/** Of the errors of the edges of \p means in other recordings. */
Matrix6d
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
  // Without others there is nothing better than how well the guess is known.
  return count > 0.0 ? covarianceOf({std::sqrt(translations / count),
                                     std::sqrt(rotations / count)})
                     : covarianceOf(guess_sd);
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

/** Join each scan to the one before it. \return how often by the guess */
int
joinAll(const RegisteredRecording& registered, std::vector<GraphEdge>& edges)
{
  const auto num_scans = static_cast<int>(registered.recording.poses.size());
  std::vector<bool> is_joined(static_cast<std::size_t>(num_scans), false);
  for (const GraphEdge& edge : edges)
    if (edge.source == edge.target + 1)
      is_joined[static_cast<std::size_t>(edge.source)] = true;
  int num_guesses = 0;
  for (int source = 1; source < num_scans; ++source)
    if (!is_joined[static_cast<std::size_t>(source)]) {
      const Isometry3d guess =
          guessOf(registered.recording, registered.seed, source - 1, source);
      edges.push_back({source - 1, source, guess.matrix(), covarianceOf(guess_sd)});
      ++num_guesses;
    }
  return num_guesses;
}

/** Poses along the edges from each scan to the one before it. */
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
  double squared_error = 0.0, num_degrees = 0.0;
  for (const app::Cycle& cycle : app::cyclesOf(edges, max_cycle_length)) {
    const app::Closure closure = app::closureOf(edges, cycle);
    if (closure.num_degrees == 0)
      continue;
    squared_error += closure.squared_error;
    num_degrees += closure.num_degrees;
    ++run.num_cycles;
  }
  run.cycle_nees = num_degrees > 0.0 ? squared_error / num_degrees : std::nan("");
}

TrajectoryRun
trajectoryOf(const std::vector<RegisteredRecording>& recordings,
             const RegisteredRecording& registered,
             const std::string& means,
             const std::string& covariances)
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
      combinedEdges(registered,
                    means,
                    covariances,
                    constantCovariance(recordings, registered, means));
  scoreCycles(edges, run);
  run.num_guesses = joinAll(registered, edges);
  run.num_edges = static_cast<int>(edges.size());
  const app::OptimizedPoses optimized = app::optimizedPoses(
      chained(edges, recording.poses.size()), edges, app::RobustLoss::None);
  run.score = scoreOf(optimized.poses, recording.poses);
  if (!optimized.complaint.empty())
    run.score.nees = run.score.nees_of_last = std::nan("");
  return run;
}

} // namespace

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
    for (const auto& [means, covariances] : combinations)
      runs.push_back(trajectoryOf(recordings, registered, means, covariances));
  return runs;
}

} // namespace bayesian_icp::evaluate
