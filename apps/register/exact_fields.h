/** \file
 * \brief The settings that only preset `exact` has: names and descriptions.
 */
#pragma once

#include "register/field.h"

namespace bayesian_icp::app {

/** \brief Call visit(field, value) for the settings of preset `exact` only. The gate
 * of its residual is that of the registration. */
template <typename ExactT, typename Visitor>
void
visitExact(ExactT& exact, Visitor& visit)
{
  visit({"exact",
         "residual",
         "residual",
         "NAME",
         "Distance to penalize: from a source point to its nearest target point, or "
         "along the target's normal there."},
        exact.residual.residual);
  visit({"exact",
         "kernel",
         "kernel",
         "NAME",
         "Robust kernel on that distance, against outliers."},
        exact.residual.kernel);
  visit({"exact",
         "kernel_width_m",
         "kernel-width",
         "M",
         "Distance from which a robust kernel differs from the square (huber) or is "
         "constant (tukey) [m]."},
        exact.residual.kernel_width);
  visit({"exact",
         "metropolis",
         "metropolis",
         "WHEN",
         "When to use Metropolis steps on the whole source instead of Langevin steps. "
         "They are exact where small mini-batches are too noisy."},
        exact.metropolis);
  visit({"exact",
         "max_source_points",
         "max-source-points",
         "N",
         "Largest number of source points. A larger source is thinned evenly over its "
         "order."},
        exact.max_source_points);
}

} // namespace bayesian_icp::app
