/** \file
 * \brief Standard point-to-point ICP to completion, without PCL and on our own tree.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/kd_tree.h>

#include <Eigen/Geometry>

#include <limits>

namespace bayesian_icp {

/** \brief When ICP stops; defaults and meaning are those of pcl::IterativeClosestPoint
 * and its DefaultConvergenceCriteria. */
struct IcpOptions {
  /** Positive. */
  int max_iterations = 10;
  /** Largest distance of corresponding points [m], positive. */
  double max_distance = std::numeric_limits<double>::infinity();
  /** Converged when the squared translation of one iteration [m^2] is not above it and
   * the cosine of its angle is at least 1 - transformation_epsilon; not negative. */
  double transformation_epsilon = 0.0;
  /** Converged when the mean squared distance of the pairs changes by less [m^2]. */
  double euclidean_fitness_epsilon = -std::numeric_limits<double>::max();
};

/** \brief Where ICP ended. */
struct IcpResult {
  /** T_target_source. */
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  int num_iterations = 0;
  /** As pcl::Registration::hasConverged(): false only without enough pairs. Stopping at
   * max_iterations counts as converged there. */
  bool has_converged = false;
  /** Of the pairs of the last iteration, before its step [m^2]. */
  double mean_squared_distance = std::numeric_limits<double>::infinity();
};

/** \brief Run ICP from \p start: the same iterations, and so the same fixed point, as
 * pcl::IterativeClosestPoint but for rounding (this one is in double).
 * \param[in] source 3 x n, finite, source frame [m]
 * \param[in] start T_target_source
 * \return has_converged false, at the last pose, where fewer than three points have a
 *         target point within max_distance */
BAYESIAN_ICP_EXPORT IcpResult
iterativeClosestPoint(const Eigen::Matrix3Xd& source,
                      const KdTree& target,
                      const Eigen::Isometry3d& start,
                      const IcpOptions& options = IcpOptions());

} // namespace bayesian_icp
