/** \file
 * \brief First-order optimisers of stochastic gradient descent. They use gradients
 * only, no point clouds.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <memory>

namespace bayesian_icp {

/** \brief How a gradient g becomes a step. All constants except the step size are those
 * of the SGD-ICP authors' program. Operations on vectors are by component, and sums
 * start at zero. */
enum class SgdOptimizer {
  /** -step_size g. */
  FixedStep,
  /** -m with m <- 0.8 m + step_size g. */
  Momentum,
  /** -u with u = sqrt(U + c) / sqrt(V + c) g, V <- 0.96 V + 0.04 g^2 before and
   * U <- 0.96 U + 0.04 u^2 after it, c = 1e-3 (Zeiler 2012). Has no step size. */
  AdaDelta,
  /** -step_size m' / (sqrt(v') + 1e-8) with m <- 0.9 m + 0.1 g, v <- 0.999 v + 0.001
   * g^2, m' = m / (1 - 0.9^t), v' = v / (1 - 0.999^t) in step t = 1, 2, ... (Kingma and
   * Ba 2015). */
  Adam,
  /** -step_size g / sqrt(V + 1e-3) with V <- 0.9 V + 0.1 g^2. Its constant is added
   * before the root and is much larger than that of RmsPropPreconditioner. */
  RmsProp
};

/** \brief Short name: "fixed", "momentum", "adadelta", "adam", "rmsprop". */
BAYESIAN_ICP_EXPORT const char*
toString(SgdOptimizer optimizer);

/** \brief The step size in the authors' program: 1, 1, 0.1, 0.01 in the order above;
 * NaN for AdaDelta, which has none. */
BAYESIAN_ICP_EXPORT double
defaultStepSize(SgdOptimizer optimizer);

/** \brief The state of one descent. */
class BAYESIAN_ICP_EXPORT DescentOptimizer {
public:
  virtual ~DescentOptimizer();

  /** \brief Use the gradient at the current position.
   * \return the step to add to the position */
  virtual Vector6d
  step(const Vector6d& gradient) = 0;
};

/** \brief Make an optimiser that has not seen a gradient.
 * \param[in] optimizer kind of optimiser
 * \param[in] step_size NaN means defaultStepSize() */
BAYESIAN_ICP_EXPORT std::unique_ptr<DescentOptimizer>
makeDescentOptimizer(SgdOptimizer optimizer, double step_size);

} // namespace bayesian_icp
