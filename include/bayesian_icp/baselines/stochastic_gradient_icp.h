/** \file
 * \brief SGD-ICP: ICP by stochastic gradient descent on mini-batches of the source
 * (Maken, Ramos, Ott: Speeding up Iterative Closest Point Using Stochastic Gradient
 * Descent, ICRA 2019).
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>

namespace bayesian_icp {

/** \brief How a gradient becomes a step. */
enum class SgdOptimizer { FixedStep, Momentum, AdaDelta, Adam, RmsProp };

/** \brief Short name: "fixed", "momentum", "adadelta", "adam", "rmsprop". */
BAYESIAN_ICP_EXPORT const char*
toString(SgdOptimizer optimizer);

/** \brief Constants of the optimisers are those of the authors' program. */
struct StochasticGradientIcpOptions {
  SgdOptimizer optimizer = SgdOptimizer::Adam;
  /** Step size; NaN: the optimiser's own (fixed 1, momentum 1, Adam 0.1, RMSProp 0.01;
   * AdaDelta has none). Positive. */
  double step_size = std::numeric_limits<double>::quiet_NaN();
  /** Source points a step; positive, more than the source has is all of it. */
  int batch_size = 150;
  /** Positive. */
  int max_iterations = 1000;
  /** Use a target point for the nearest of a mini-batch's source points only. */
  bool is_one_to_one = true;
  /** Converged when for so many iterations no translation [m] and no angle [rad] has
   * changed by more than these. */
  double translation_epsilon = 1e-4;
  double rotation_epsilon = 1e-4;
  int num_still_iterations = 10;
  std::uint64_t seed = 1;

  /** \brief What is wrong with the first bad field; empty if all is well. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief Where the descent ended. */
struct StochasticGradientIcpResult {
  /** T_target_source as a pose [m, rad]. */
  Vector6d pose = Vector6d::Zero();
  int num_iterations = 0;
  /** False where max_iterations came first, no correspondence was found, or the pose
   * became non-finite. */
  bool has_converged = false;
};

/** \brief Called after each step with the pose; returns false to stop. */
using StochasticGradientIcpProgress =
    std::function<bool(int iteration, const Vector6d& pose)>;

/** \brief Descend from \p initial_pose.
 * \param[in] source_points 3 x n, finite, source frame [m]
 * \param[in] search finds correspondences within its gate; called by this thread only
 */
BAYESIAN_ICP_EXPORT StochasticGradientIcpResult
stochasticGradientIcp(
    const Eigen::Matrix3Xd& source_points,
    const CorrespondenceSearch& search,
    const Vector6d& initial_pose,
    const StochasticGradientIcpOptions& options = StochasticGradientIcpOptions(),
    const StochasticGradientIcpProgress& progress = StochasticGradientIcpProgress());

} // namespace bayesian_icp
