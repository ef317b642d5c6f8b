/** \file
 * \brief Derivatives of one pair's residual in twists about a centre.
 */
#pragma once

#include "baselines/hessian_covariance.h"

namespace bayesian_icp {

using Matrix36d = Eigen::Matrix<double, 3, 6>;
using Matrix63d = Eigen::Matrix<double, 6, 3>;

/** \brief A = [I, -[arm]x]: how a point moves with the twist (v, w). */
inline Matrix36d
motionOf(const Eigen::Vector3d& arm)
{
  Matrix36d motion;
  motion << Eigen::Matrix3d::Identity(), -crossMatrix(arm);
  return motion;
}

/** \brief One pair. With N = I, or n n^T if there is a normal, its energy is
 * 0.5 (p - q)^T N (p - q). */
struct MatchedPair {
  MatchedPair(const MatchedPoints& matches,
              Eigen::Index i,
              const Eigen::Vector3d& centre)
  : arm(matches.moved.col(i) - centre)
  , motion(motionOf(arm))
  , projector(Eigen::Matrix3d::Identity())
  {
    if (matches.hasNormals())
      projector = matches.normals.col(i) * matches.normals.col(i).transpose();
    force = projector * (matches.moved.col(i) - matches.target.col(i));
  }

  /** p - centre. */
  Eigen::Vector3d arm;
  /** A. */
  Matrix36d motion;
  /** N. */
  Eigen::Matrix3d projector;
  /** f = N (p - q). */
  Eigen::Vector3d force;
};

} // namespace bayesian_icp
