/** \file
 * \brief PCL's own registrations, on clouds in double precision.
 */
#pragma once

#include <Eigen/Geometry>

#include <vector>

namespace bayesian_icp::evaluate {

/** \brief The clouds of a registration and where it starts. */
struct PclProblem {
  /** 3 x n, finite [m]. */
  const Eigen::Matrix3Xd& source;
  const Eigen::Matrix3Xd& target;
  /** Columns of the source that are registered. */
  const std::vector<Eigen::Index>& source_columns;
  /** T_target_source. */
  Eigen::Isometry3d guess;
};

struct PclFit {
  bool has_converged = false;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/** \brief pcl::IterativeClosestPoint without a gate, until its steps are short. */
PclFit
fitPclIcp(const PclProblem& problem);

/** \brief pcl::GeneralizedIterativeClosestPoint with its defaults, but 50 iterations,
 * on the whole source.
 * \return the guess, not converged, if a cloud has fewer points than a plane's
 *         neighbourhood */
PclFit
fitPclGicpAsIs(const PclProblem& problem);

struct GicpFit {
  PclFit fit;
  /** The source points that were registered, moved, target frame [m]. */
  Eigen::Matrix3Xd moved;
  /** C_target + R C_source R^T of each and its nearest target point: 1 along the plane,
   * 0.001 across, as GICP has them. */
  std::vector<Eigen::Matrix3d> covariances;
};

/** \brief pcl::GeneralizedIterativeClosestPoint with its default planes, until its
 * steps are short. Planes of source points are those of the whole source.
 * \return not converged if a cloud has fewer points than a plane's neighbourhood */
GicpFit
fitPclGicp(const PclProblem& problem);

} // namespace bayesian_icp::evaluate
