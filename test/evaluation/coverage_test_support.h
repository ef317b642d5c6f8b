/** \file
 * \brief Posteriors that are right by construction, for the tests of the coverage
 * study.
 */
#pragma once

#include "coverage/coverage_study.h"
#include "geometry/twist.h"

#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

#include <functional>
#include <vector>

namespace bayesian_icp::evaluate {

/** Standard deviation of the posterior in units of the prior's. */
constexpr double relative_width = 0.2;

struct RightPosterior {
  CoverageCase problem;
  MethodResult result;
};

/** A Gaussian about a random pose, as wide in every direction of the
 * scaled coordinates; the truth is drawn from it, and so are the draws, if any. */
inline RightPosterior
rightPosterior(std::uint64_t seed, Eigen::Index num_draws)
{
  Random random(seed, 1);
  RightPosterior right;
  CoverageCase& problem = right.problem;
  problem.scene = "scene";
  problem.condition = "condition";
  problem.seed = seed;
  problem.prior_sd << 0.03, 0.04, 0.05, 0.06, 0.07, 0.08;
  problem.source.resize(3, 20);
  for (Eigen::Index i = 0; i < problem.source.size(); ++i)
    problem.source(i) = 2.0 + random.normal();
  problem.target = problem.source;
  MethodResult& result = right.result;
  result.is_valid = true;
  result.mean = isometryOf(random.normal6());
  result.centre = result.mean * Eigen::Vector3d(problem.source.rowwise().mean());
  const Matrix6d scale = relative_width * problem.prior_sd.asDiagonal();
  result.covariance = scale * scale;
  const auto draw = [&]() -> Eigen::Isometry3d {
    return movedBy(scale * random.normal6(), result.centre, result.mean);
  };
  problem.truth = draw();
  result.draws.resize(num_draws, 6);
  for (Eigen::Index i = 0; i < num_draws; ++i)
    result.draws.row(i) = poseOf(draw().matrix()).transpose();
  return right;
}

/** Of a number of the scores that all runs have. */
template <typename Number>
double
meanOf(const std::vector<CoverageRun>& runs, const Number& number)
{
  double sum = 0.0;
  for (const CoverageRun& run : runs)
    sum += static_cast<double>(std::invoke(number, run.score));
  return sum / static_cast<double>(runs.size());
}

/** Mean of nees / 6. */
inline double
aneesOf(const std::vector<CoverageRun>& runs)
{
  return meanOf(runs, &CoverageScore::nees) / 6.0;
}

/** Share of the truths within the regions of a probability. */
inline double
coverageOf(const std::vector<CoverageRun>& runs, double level)
{
  return meanOf(runs,
                [=](const CoverageScore& score) { return score.region <= level; });
}

} // namespace bayesian_icp::evaluate
