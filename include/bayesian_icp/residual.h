/** \file
 * \brief The contribution of a matched source point to the energy: residual and robust
 * kernel.
 */
#pragma once

#include <bayesian_icp/export.h>

#include <limits>

namespace bayesian_icp {

/** \brief Definition of the residual r, whose energy is rho(r). */
enum class Residual {
  /** Distance of the moved source point to the nearest target point. */
  PointToPoint,
  /** Distance along the target's normal at the nearest target point. Its energy jumps
   * where the nearest point changes, so only Metropolis steps are exact for it. */
  PointToPlane
};

/** \brief The function rho. */
enum class RobustKernel {
  /** r^2 / 2. */
  None,
  /** r^2 / 2 up to the width k, and k (r - k/2) beyond it. */
  Huber,
  /** Tukey's biweight: k^2/6 (1 - (1 - (r/k)^2)^3) up to the width k, and k^2/6 beyond
   * it. */
  Tukey
};

/** \brief Short name: "point-to-point" or "point-to-plane". */
BAYESIAN_ICP_EXPORT const char*
toString(Residual residual);

/** \brief Short name: "none", "huber" or "tukey". */
BAYESIAN_ICP_EXPORT const char*
toString(RobustKernel kernel);

/** \brief Residual, kernel and gate of the preset `exact`. */
struct ResidualOptions {
  Residual residual = Residual::PointToPoint;
  RobustKernel kernel = RobustKernel::None;
  /** Width k of the kernel [m], positive. Not used by RobustKernel::None. */
  double kernel_width = 0.01;
  /** d_max, the gate on the distance to the nearest target point [m]. Positive;
   * infinity means no gate. A point without a target point within the gate contributes
   * rho(d_max). A search of the user's own has its own gate: set this value to the
   * same one. */
  double max_distance = std::numeric_limits<double>::infinity();
};

/** \brief rho(r) [m^2] of a squared residual r^2 [m^2]. */
BAYESIAN_ICP_EXPORT double
robustEnergy(const ResidualOptions& options, double squared_residual);

/** \brief rho'(r) / r, dimensionless: 1 without a kernel. */
BAYESIAN_ICP_EXPORT double
robustWeight(const ResidualOptions& options, double squared_residual);

/** \brief Energy of a point without a match [m^2]: rho(d_max), or 0 without a gate. In
 * the latter case only a user's rejectors leave points unmatched. */
BAYESIAN_ICP_EXPORT double
unmatchedEnergy(const ResidualOptions& options);

} // namespace bayesian_icp
