/** \file
 * \brief A known density for the tests of the evaluation app.
 */
#pragma once

#include "study/draw_statistics.h"

#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

namespace bayesian_icp::evaluate {

/** A correlated Gaussian whose standard deviations differ by 1000. */
inline Moments
exampleGaussian()
{
  Moments gaussian;
  gaussian.mean << 0.1, -0.2, 0.3, 0.5, -1.0, 2.0;
  Matrix6d factor = Matrix6d::Identity();
  factor(5, 0) = 0.9;
  factor(3, 1) = -0.7;
  Vector6d scale;
  scale << 0.001, 0.01, 0.1, 1.0, 0.02, 0.5;
  factor = scale.asDiagonal() * factor;
  gaussian.covariance = factor * factor.transpose();
  return gaussian;
}

inline PoseMatrix
gaussianDraws(const Moments& gaussian, Eigen::Index num_draws, std::uint64_t seed)
{
  const Matrix6d factor = gaussian.covariance.llt().matrixL();
  Random random(seed, 0);
  PoseMatrix draws(num_draws, 6);
  for (Eigen::Index i = 0; i < num_draws; ++i)
    draws.row(i) = (gaussian.mean + factor * random.normal6()).transpose();
  return draws;
}

} // namespace bayesian_icp::evaluate
