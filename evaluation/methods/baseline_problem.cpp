#include "methods/baseline_problem.h"

#include "algebra/decompositions.h"
#include "geometry/twist.h"

#include <bayesian_icp/random.h>

#include <limits>
#include <numeric>

namespace bayesian_icp::evaluate {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/** Random numbers of the choice of source points. */
constexpr std::uint64_t choice_stream = 2101;

/** ICP stops at a shorter step, and takes none that is longer [m, rad]. */
constexpr double min_step = 1e-6;
constexpr double max_step = 0.2;

/** First weight of the residuals: a noise of 1 cm. */
constexpr double first_weight = 1e4;

/** All columns, or \p count of them at random. */
std::vector<Index>
chosenColumns(Index num_columns, Index count, std::uint64_t seed)
{
  if (num_columns > count) {
    Random random(seed, choice_stream);
    return randomChoice(num_columns, count, random);
  }
  std::vector<Index> columns(static_cast<std::size_t>(num_columns));
  std::iota(columns.begin(), columns.end(), Index(0));
  return columns;
}

Matrix3Xd
normalsOfMatches(const Matrix3Xd& target_normals, const MatchedPoints& matches)
{
  Matrix3Xd normals(3, matches.moved.cols());
  for (Index i = 0; i < normals.cols(); ++i)
    normals.col(i) =
        target_normals.col(matches.target_indices[static_cast<std::size_t>(i)]);
  return normals;
}

} // namespace

BaselineProblem::BaselineProblem(const CoverageCase& registered, Index max_points)
: coverage_case(registered)
, source_columns(chosenColumns(registered.source.cols(), max_points, registered.seed))
, source(registered.source(Eigen::all, source_columns))
, prior(registered.prior_mean,
        registered.prior_sd.cwiseAbs2(),
        registered.source.rowwise().mean())
, origin_(registered.target.col(0))
, tree_((registered.target.colwise() - origin_).cast<float>())
, hints_(source_columns.size(), KdTree::none)
{}

Isometry3d
BaselineProblem::priorMean() const
{
  return isometryOf(prior.mean());
}

MatchedPoints
BaselineProblem::match(const Isometry3d& T_target_source) const
{
  MatchedPoints matches;
  matches.moved = T_target_source * source;
  matches.target.resize(3, source.cols());
  for (std::size_t i = 0; i < hints_.size(); ++i) {
    const auto column = static_cast<Index>(i);
    const Vector3d query = matches.moved.col(column) - origin_;
    hints_[i] = tree_
                    .nearest(query.cast<float>(),
                             std::numeric_limits<float>::infinity(),
                             hints_[i])
                    .index;
    matches.target.col(column) = coverage_case.target.col(hints_[i]);
  }
  matches.target_indices = hints_;
  num_queries_ += source.cols();
  return matches;
}

MethodResult
BaselineProblem::combineWithPrior(const Isometry3d& T_target_source,
                                  const GaussianInformation& likelihood) const
{
  MethodResult result;
  result.centre = centreAt(T_target_source);
  const TwistPrior twist_prior = twistPrior(prior, T_target_source, result.centre);
  const Matrix6d covariance =
      (likelihood.information + twist_prior.precision).inverse();
  result.covariance = 0.5 * (covariance + covariance.transpose());
  result.mean =
      movedBy(-result.covariance * (likelihood.gradient + twist_prior.gradient),
              result.centre,
              T_target_source);
  result.num_queries = num_queries_;
  result.is_valid = result.covariance.allFinite() && result.mean.matrix().allFinite();
  if (!result.is_valid)
    result.notes = "not finite";
  return result;
}

IcpFit
fitIcp(const BaselineProblem& problem, const IcpCost& cost, const Isometry3d& start)
{
  IcpFit fit;
  const auto moveTo = [&](const Isometry3d& pose) {
    fit.pose = pose;
    fit.matches = problem.match(pose);
    if (cost.normals.cols() > 0)
      fit.matches.normals = normalsOfMatches(cost.normals, fit.matches);
  };
  moveTo(start);
  for (int i = 0; i < cost.max_steps; ++i) {
    const Vector3d centre = problem.centreAt(fit.pose);
    const GaussNewton sums = gaussNewton(fit.matches, centre);
    const TwistPrior prior = twistPrior(problem.prior, fit.pose, centre);
    const Matrix6d curvature = cost.weight * sums.hessian + prior.precision;
    Vector6d step =
        -curvature.ldlt().solve(cost.weight * sums.gradient + prior.gradient);
    const double length = step.norm();
    if (!(length > min_step))
      break;
    if (length > max_step)
      step *= max_step / length;
    moveTo(movedBy(step, centre, fit.pose));
  }
  return fit;
}

IcpFit
fitNaively(const BaselineProblem& problem)
{
  const auto varianceAt = [&](const IcpFit& fit) {
    return residualVariance(gaussNewton(fit.matches, problem.centreAt(fit.pose)));
  };
  IcpCost cost;
  cost.weight = first_weight;
  IcpFit fit = fitIcp(problem, cost, problem.priorMean());
  cost.weight = 1.0 / varianceAt(fit);
  cost.max_steps = 20;
  fit = fitIcp(problem, cost, fit.pose);
  fit.variance = varianceAt(fit);
  return fit;
}

} // namespace bayesian_icp::evaluate
