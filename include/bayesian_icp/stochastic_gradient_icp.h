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

/** \brief Options of SGD-ICP. The defaults are those of the authors' program:
 * docs/sgd_icp.md. */
struct StochasticGradientIcpOptions {
  SgdOptimizer optimizer = SgdOptimizer::Adam;
  /** Positive; NaN means defaultStepSize(). AdaDelta does not use it. */
  double step_size = std::numeric_limits<double>::quiet_NaN();
  /** Source points per step, positive. If the source has fewer, all are used. */
  int batch_size = 150;
  /** Largest number of steps, positive. */
  int max_iterations = 150;
  /** Pair each target point only with the nearest source point of a mini-batch. */
  bool is_one_to_one = true;
  /** The pose is at rest while the change of its translation [m] and the sum of the
   * absolute changes of its angles [rad], since it came to rest, are below these
   * limits. Not negative; 0 means never. */
  double translation_epsilon = 5e-3;
  double rotation_epsilon = 5e-3;
  /** Number of consecutive steps at rest that count as converged, positive. */
  int num_still_iterations = 5;
  std::uint64_t seed = 1;

  /** \brief Describe the first invalid field. Empty if all fields are valid. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief Why a descent ended. */
enum class DescentEnd {
  Converged,
  MaxIterations,
  /** A hundred mini-batches (one, if it is the whole source) had fewer than three
   * points with a correspondence. */
  TooFewCorrespondences,
  /** The pose became non-finite. */
  Diverged,
  /** The progress callback stopped the descent. */
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
  /** The last finite pose, T_target_source, canonical [m, rad]; zero if there is none.
   */
  Vector6d pose = Vector6d::Zero();
  /** Number of steps; mini-batches with too few correspondences make none. */
  int num_iterations = 0;
  /** Whether the pose came to rest: end is Converged. */
  bool has_converged = false;
  DescentEnd end = DescentEnd::InvalidInput;
};

/** \brief Called after each step, counted from 1, with the pose (angles not wrapped).
 * It returns false to stop. */
using StochasticGradientIcpProgress =
    std::function<bool(int iteration, const Vector6d& pose)>;

/** \brief Descend the mean of |R s + u - q|^2 / 2 over the pairs of each mini-batch
 * from \p initial_pose. Mini-batches come from shuffled epochs of the source.
 * \param[in] source_points 3 x n, finite, source frame [m]
 * \param[in] search finds correspondences within its gate; only this thread calls it
 * \param[in] initial_pose T_target_source [m, rad]
 * \param[in] options step size, mini-batches and stopping criteria
 * \param[in] progress called after each step; may be empty */
BAYESIAN_ICP_EXPORT StochasticGradientIcpResult
stochasticGradientIcp(
    const Eigen::Matrix3Xd& source_points,
    const CorrespondenceSearch& search,
    const Vector6d& initial_pose,
    const StochasticGradientIcpOptions& options = StochasticGradientIcpOptions(),
    const StochasticGradientIcpProgress& progress = StochasticGradientIcpProgress());

} // namespace bayesian_icp
