/** \file
 * \brief The contribution of a matched source point to the energy: residual and robust
 * kernel.
 */
#pragma once

#include <bayesian_icp/options.h>

namespace bayesian_icp {

/** \brief rho(r) [m^2] of a squared residual r^2 [m^2]. */
double
robustEnergy(const ResidualOptions& options, double squared_residual);

/** \brief rho'(r) / r, dimensionless: 1 without a kernel. */
double
robustWeight(const ResidualOptions& options, double squared_residual);

/** \brief Energy of a point without a match [m^2]: rho(d_max), or 0 without a gate. In
 * the latter case only a user's rejectors leave points unmatched. */
double
unmatchedEnergy(const ResidualOptions& options);

} // namespace bayesian_icp
