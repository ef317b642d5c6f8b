#include "trajectories/registered_edge.h"

#include "algebra/decompositions.h"
#include "io/clocks.h"
#include "io/text_hash.h"
#include "methods/published_covariances.h"
#include "track/registration.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

namespace bayesian_icp::evaluate {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;

namespace {

constexpr int min_closure_gap = 10, scans_between_closures = 5;
constexpr Eigen::Index max_baseline_points = 5000;

/** \throws std::runtime_error if a graph cannot use the covariance */
void
take(const Vector6d& mean, const Matrix6d& covariance, EdgeRun& run)
{
  if (!covariance.allFinite() || covariance.llt().info() != Eigen::Success)
    throw std::runtime_error("no covariance");
  run.mean = mean;
  run.covariance = covariance;
}

void
takeTwist(const TwistGaussian& posterior, EdgeRun& run)
{
  // exp(xi) about the centre c is T exp(Ad(T^-1 C) xi), C the shift by c.
  const Isometry3d into_source =
      posterior.mean.inverse() * Eigen::Translation3d(posterior.centre);
  const Matrix6d carry = app::adjointOf(into_source.matrix());
  take(poseOf(posterior.mean.matrix()),
       carry * posterior.covariance * carry.transpose(),
       run);
}

/** As pcl_bayesian_icp_track does.
 * \throws std::runtime_error if it is of no use */
void
registerCalibrated(const CoverageCase& problem, EdgeRun& run)
{
  Options options;
  options.prior.mean = problem.prior_mean;
  options.prior.frame = PriorFrame::Origin;
  options.chains.num_threads = 1;
  const app::Registration registration =
      app::registered(problem.source, problem.target, options, nullptr);
  if (registration.quality == app::Quality::Useless)
    throw std::runtime_error(registration.message);
  take(registration.edge.pose.mean, registration.edge.pose.covariance, run);
}

void
registerBy(const std::string& method, const CoverageCase& problem, EdgeRun& run)
{
  if (method == "calibrated")
    registerCalibrated(problem, run);
  else if (method == "gicp")
    takeTwist(gicpHessian(problem, max_baseline_points), run);
  else
    takeTwist(planeClosedForm(problem, std::nan(""), max_baseline_points), run);
}

/** The nearest scan long before \p source, or -1. */
int
closureOf(const Recording& recording, int source, double distance)
{
  int nearest = -1;
  const auto at = [&recording](int scan) {
    return recording.poses.at(static_cast<std::size_t>(scan)).translation();
  };
  for (int target = 0; target + min_closure_gap <= source; ++target) {
    const double length = (at(target) - at(source)).norm();
    if (length < distance) {
      distance = length;
      nearest = target;
    }
  }
  return nearest;
}

} // namespace

app::GraphEdge
graphEdgeOf(const EdgeRun& run)
{
  app::GraphEdge edge;
  edge.target = run.name.target;
  edge.source = run.name.source;
  edge.T_target_source = matrixOf(run.mean);
  edge.covariance = run.covariance.selfadjointView<Eigen::Upper>();
  return edge;
}

std::vector<std::pair<int, int>>
pairsOf(const Recording& recording, int span, double closure_distance)
{
  std::vector<std::pair<int, int>> pairs;
  for (int source = 1; source < static_cast<int>(recording.poses.size()); ++source) {
    for (int target = source - 1; target >= std::max(0, source - span); --target)
      pairs.emplace_back(target, source);
    if (source % scans_between_closures != 0)
      continue;
    const int closure = closureOf(recording, source, closure_distance);
    if (closure >= 0)
      pairs.emplace_back(closure, source);
  }
  return pairs;
}

Isometry3d
guessOf(const Recording& recording, std::uint64_t seed, int target, int source)
{
  Random random(
      seed,
      io::hashOf(recording.name + ' ' + io::textOf(target) + ' ' + io::textOf(source)));
  return perturbed(recording.relativePose(static_cast<std::size_t>(target),
                                          static_cast<std::size_t>(source)),
                   guess_sd,
                   random);
}

EdgeRun
registeredEdge(const EdgeName& name,
               const Matrix3Xd& source,
               const Matrix3Xd& target,
               const Isometry3d& guess)
{
  CoverageCase problem;
  problem.source = source;
  problem.target = target;
  problem.prior_mean = poseOf(guess.matrix());
  problem.prior_sd = PriorOptions().variance.cwiseSqrt();
  EdgeRun run;
  run.name = name;
  run.mean = problem.prior_mean;
  const double begin = io::wallSeconds();
  try {
    registerBy(name.method, problem, run);
  }
  catch (const std::bad_alloc&) {
    throw; // no fault of the method
  }
  catch (const std::exception& error) {
    run.complaint = error.what();
  }
  run.seconds = io::wallSeconds() - begin;
  return run;
}

} // namespace bayesian_icp::evaluate
