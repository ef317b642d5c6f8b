#include "coverage/coverage_score.h"

#include "geometry/twist.h"
#include "study/draw_statistics.h"

#include <bayesian_icp/random.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bayesian_icp::evaluate {

namespace {

/** Streams of random numbers that no method uses. */
constexpr std::uint64_t gaussian_stream = 0x636f766572;
constexpr std::uint64_t truth_stream = gaussian_stream + 1;

constexpr Eigen::Index num_gaussian_draws = 2000;
constexpr Eigen::Index min_draws = 8;

/** The posterior about MethodResult::mean, as twists. */
struct TwistPosterior {
  Moments moments;
  /** Draws of the method, one per row; none if it is a Gaussian. */
  PoseMatrix draws;
  Vector6d truth;
  /** F, where F F^T is the covariance of the truth itself. */
  Matrix6d truth_factor;
};

double
normalProbability(double x)
{
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/** Nodes of the midpoint rule over a chi-square variable: quantiles of equal weight.
 * With no degree of freedom it is zero. */
std::vector<double>
nodesOf(int degrees_of_freedom)
{
  constexpr int num_nodes = 64;
  if (degrees_of_freedom == 0)
    return {0.0};
  const boost::math::chi_squared distribution(degrees_of_freedom);
  std::vector<double> nodes(num_nodes);
  for (int i = 0; i < num_nodes; ++i)
    nodes[i] = boost::math::quantile(distribution, (i + 0.5) / num_nodes);
  return nodes;
}

/** Of \p distance or less. */
double
chiSquaredProbability(int degrees_of_freedom, double distance)
{
  return boost::math::cdf(boost::math::chi_squared(degrees_of_freedom),
                          std::max(0.0, distance));
}

/** F of the truth. Recordings state how accurately the pose of the sensor is known: the
 * turn, and where it puts the sensor. */
Matrix6d
truthFactor(const CoverageCase& problem, const MethodResult& result)
{
  const Vector6d sd = problem.truth_sd.vector();
  Matrix6d factor = sd.asDiagonal();
  const Eigen::Vector3d sensor = result.mean * problem.sensor - result.centre;
  for (int k = 0; k < 3 && !std::isnan(problem.lost_displacement); ++k)
    factor.col(3 + k).head<3>() = sd[3 + k] * sensor.cross(Eigen::Vector3d::Unit(k));
  return factor;
}

TwistPosterior
posteriorOf(const CoverageCase& problem, const MethodResult& result)
{
  TwistPosterior posterior;
  posterior.truth = twistBetween(result.mean, problem.truth, result.centre);
  posterior.truth_factor = truthFactor(problem, result);
  posterior.draws.resize(result.draws.rows(), 6);
  for (Eigen::Index i = 0; i < result.draws.rows(); ++i)
    posterior.draws.row(i) = twistBetween(result.mean,
                                          isometryOf(result.draws.row(i).transpose()),
                                          result.centre)
                                 .transpose();
  if (result.draws.rows() == 0)
    posterior.moments.covariance = result.covariance;
  else
    posterior.moments = momentsOf(posterior.draws);
  posterior.moments.covariance +=
      posterior.truth_factor * posterior.truth_factor.transpose();
  return posterior;
}

Vector6d
pitOf(const TwistPosterior& posterior)
{
  Vector6d pit;
  for (int k = 0; k < 6; ++k) {
    const double truth = posterior.truth[k];
    const double sd = posterior.truth_factor.row(k).norm();
    if (posterior.draws.rows() == 0) {
      pit[k] = normalProbability((truth - posterior.moments.mean[k]) /
                                 std::sqrt(posterior.moments.covariance(k, k)));
      continue;
    }
    double sum = 0.0;
    for (const double x : posterior.draws.col(k))
      sum += sd > 0.0 ? normalProbability((truth - x) / sd)
                      : (x < truth ? 1.0 : 0.0) + (x == truth ? 0.5 : 0.0);
    pit[k] = sum / static_cast<double>(posterior.draws.rows());
  }
  return pit;
}

/** Draws that include the truth's own accuracy. */
PoseMatrix
scoredDraws(const TwistPosterior& posterior, const Matrix6d& factor, std::uint64_t seed)
{
  if (posterior.draws.rows() == 0) {
    Random random(seed, gaussian_stream);
    PoseMatrix draws(num_gaussian_draws, 6);
    for (Eigen::Index i = 0; i < draws.rows(); ++i)
      draws.row(i) = (posterior.moments.mean + factor * random.normal6()).transpose();
    return draws;
  }
  PoseMatrix draws = posterior.draws;
  Random random(seed, truth_stream);
  if (!posterior.truth_factor.isZero(0.0))
    for (Eigen::Index i = 0; i < draws.rows(); ++i)
      draws.row(i) += (posterior.truth_factor * random.normal6()).transpose();
  return draws;
}

void
addGaussianScores(const CoverageCase& problem,
                  const TwistPosterior& posterior,
                  const Matrix6d& factor,
                  const RegionShape& shape,
                  CoverageScore& score)
{
  const Vector6d deviation = posterior.truth - posterior.moments.mean;
  const Vector6d sd = posterior.moments.covariance.diagonal().cwiseSqrt();
  score.nees = factor.triangularView<Eigen::Lower>().solve(deviation).squaredNorm();
  score.region = regionOf(score.nees, shape);
  score.relative_sd = sd.cwiseQuotient(problem.prior_sd);
  score.z = deviation.cwiseQuotient(sd);
  const double log_density = -0.5 * score.nees - 3.0 * std::log(2.0 * std::acos(-1.0)) -
                             factor.diagonal().array().log().sum();
  score.log_score = score.hasLimit()
                        ? std::max(log_density, min_log_score)
                        : log_density + problem.prior_sd.array().log().sum();
}

void
addErrors(const CoverageCase& problem,
          const Eigen::Isometry3d& pose,
          CoverageScore& score)
{
  const Eigen::Vector3d centroid = problem.source.rowwise().mean();
  score.translation_error = (pose * centroid - problem.truth * centroid).norm();
  score.rotation_error =
      logSO3(problem.truth.linear() * pose.linear().transpose()).norm();
  score.displacement =
      (pose * problem.source - problem.truth * problem.source).colwise().norm().mean();
}

void
addNote(const std::string& note, std::string& notes)
{
  notes += (notes.empty() ? "" : ";") + note;
}

/** Scores of a posterior; score.is_valid says whether it is one. */
void
addPosterior(const CoverageCase& problem,
             const MethodResult& result,
             CoverageScore& score)
{
  if (result.draws.rows() > 0 && result.draws.rows() < min_draws) {
    addNote("too few draws", score.notes);
    return;
  }
  const TwistPosterior posterior = posteriorOf(problem, result);
  const auto factor = factorOf(posterior.moments.covariance);
  if (!factor || !posterior.truth.allFinite() || !posterior.moments.mean.allFinite()) {
    addNote("not a posterior", score.notes);
    return;
  }
  score.is_valid = true;
  addGaussianScores(problem, posterior, *factor, result.shape, score);
  score.pit = pitOf(posterior);
  const auto scale = problem.prior_sd.cwiseInverse().asDiagonal();
  score.energy_score =
      energyScore(scoredDraws(posterior, *factor, problem.seed) * scale,
                  (scale * posterior.truth).transpose());
  addErrors(problem, result.mean, score);
}

} // namespace

bool
CoverageScore::isFlagged() const
{
  return notes.compare(0, 5, "flag:") == 0 || notes.find(";flag:") != std::string::npos;
}

double
regionOf(double nees, const RegionShape& shape)
{
  if (!std::isfinite(nees))
    return nees;
  const int nu = shape.degrees_of_freedom, k = shape.num_held;
  if (nu == 0 || k == 0)
    return chiSquaredProbability(6, nees);
  // P(w X + Y < nees), X and Y chi-square with k and 6 - k degrees of freedom.
  const std::vector<double> scales = nodesOf(nu), others = nodesOf(6 - k);
  double sum = 0.0;
  for (const double scale : scales)
    for (const double other : others)
      sum += chiSquaredProbability(k, (nees - other) * scale / (nu - 2));
  return sum / static_cast<double>(scales.size() * others.size());
}

CoverageScore
coverageScoreOf(const CoverageCase& problem, const MethodResult& result)
{
  CoverageScore score;
  score.lost_displacement = problem.lost_displacement;
  score.seconds = result.seconds;
  score.num_queries = result.num_queries;
  score.notes = result.notes;
  if (result.is_valid && !result.is_pose_only)
    addPosterior(problem, result, score);
  else if (result.is_valid && result.mean.matrix().allFinite())
    addErrors(problem, result.mean, score);
  if (score.hasLimit() && !score.hasPose()) {
    score.region = 1.0;
    score.log_score = min_log_score;
  }
  return score;
}

} // namespace bayesian_icp::evaluate
