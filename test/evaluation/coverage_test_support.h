/** \file
 * \brief Posteriors that are right by construction, for the tests of the coverage
 * study.
 */
#pragma once

#include "geometry/twist.h"
#include "study/coverage_case.h"

#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

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

} // namespace bayesian_icp::evaluate
