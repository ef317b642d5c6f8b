/** \file
 * \brief How far the draws of a method are from the baseline and from the truth.
 */
#pragma once

#include "paper/paper_baseline.h"
#include "paper/paper_runs.h"

namespace bayesian_icp::evaluate {

/** \brief Distance of a run's draws to the baseline and to the truth.
 * \param[in] name goes into the result */
DistributionRun
distributionRunOf(const PaperRunName& name,
                  const ScanPair& pair,
                  const SamplerRun& run,
                  const PaperBaseline& baseline);

} // namespace bayesian_icp::evaluate
