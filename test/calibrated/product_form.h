// The oracle of calibrated draws.
#pragma once

#include "calibrated/calibrated_estimate.h"
#include "sampler/chain_set.h"

namespace bayesian_icp {
namespace test {

/** Draws as if the likelihood were Gaussian about the mode, in ProductCoordinates, with
 * the exact prior: Metropolis steps that look at no points. Right however wide the
 * prior is along motions that it alone holds. Thinning is in units of three Metropolis
 * steps.
 */
ChainSet
sampleProductForm(const Prior& prior,
                  const CalibratedEstimate& estimate,
                  int thinning = 1);

} // namespace test
} // namespace bayesian_icp
