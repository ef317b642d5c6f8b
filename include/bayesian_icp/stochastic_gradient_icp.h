/** \file
 * \brief SGD-ICP: ICP by stochastic gradient descent on mini-batches of the source
 * (Maken, Ramos, Ott: Speeding up Iterative Closest Point Using Stochastic Gradient
 * Descent, ICRA 2019).
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/descent_optimizer.h>
#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>

namespace bayesian_icp {

/** \brief Defaults are those of the authors' program; docs/sgd_icp.md says which. */
struct StochasticGradientIcpOptions {
  SgdOptimizer optimizer = SgdOptimizer::Adam;
  /** Positive; NaN: defaultStepSize(). No effect on AdaDelta. */
  double step_size = std::numeric_limits<double>::quiet_NaN();
  /** Source points per step, positive. If the source has fewer, all are used. */
  int batch_size = 150;
  /** Positive. */
  int max_iterations = 150;
  /** Use a target point for the nearest of a mini-batch's source points only. */
  bool is_one_to_one = true;
  /** The pose is still while its translation [m] and the sum of its three angles'
   * changes [rad] are less than these away from where it came to rest; not negative, 0
   * is never. */
  double translation_epsilon = 5e-3;
  double rotation_epsilon = 5e-3;
  /** Number of consecutive still steps that count as converged, positive. */
  int num_still_iterations = 5;
  std::uint64_t seed = 1;

  /** \brief What is wrong with the first bad field; empty if all is well. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief Why a descent ended. */
enum class DescentEnd {
  Converged,
  MaxIterations,
  /** A hundred mini-batches had fewer than three points with a correspondence. */
  TooFewCorrespondences,
  /** The pose became non-finite. */
  Diverged,
  /** The progress callback asked for it. */
  Cancelled,
  /** Bad options, fewer than three source points, or a non-finite initial pose. For the
   * class of PCL, also a refused cloud, or indices outside their cloud. */
  InvalidInput
};

/** \brief Short name: "converged", "max_iterations", "too_few_correspondences",
 * "diverged", "interrupted", "invalid_input". */
BAYESIAN_ICP_EXPORT const char*
toString(DescentEnd end);

/** \brief Where the descent ended. */
struct StochasticGradientIcpResult {
  /** T_target_source as a canonical pose [m, rad]: the last finite one. */
  Vector6d pose = Vector6d::Zero();
  /** Steps made; mini-batches with too few correspondences make none. */
  int num_iterations = 0;
  /** Whether the pose came to rest: end is Converged. */
  bool has_converged = false;
  DescentEnd end = DescentEnd::InvalidInput;
};

/** \brief Called after each step, counted from 1, with the pose (angles as they come,
 * not wrapped); returns false to stop. */
using StochasticGradientIcpProgress =
    std::function<bool(int iteration, const Vector6d& pose)>;

/** \brief Descend the mean of |R s + u - q|^2 / 2 over the pairs of each mini-batch
 * from \p initial_pose. The source is dealt out in shuffled epochs.
 * \param[in] source_points 3 x n, finite, source frame [m]
 * \param[in] search finds correspondences within its gate; called by this thread only
 * \param[in] initial_pose T_target_source [m, rad]
 * \param[in] options step size, batches and when to stop
 * \param[in] progress told of each step; may be empty */
BAYESIAN_ICP_EXPORT StochasticGradientIcpResult
stochasticGradientIcp(
    const Eigen::Matrix3Xd& source_points,
    const CorrespondenceSearch& search,
    const Vector6d& initial_pose,
    const StochasticGradientIcpOptions& options = StochasticGradientIcpOptions(),
    const StochasticGradientIcpProgress& progress = StochasticGradientIcpProgress());

} // namespace bayesian_icp
