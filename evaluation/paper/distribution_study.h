/** \file
 * \brief The runs behind Table I: those that are missing are made.
 */
#pragma once

#include "paper/distribution_file.h"
#include "paper/paper_baseline.h"
#include "paper/paper_methods.h"

#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Distance of a run's draws to the baseline and to the truth.
 * \param[in] name goes into the result */
DistributionRun
distributionRunOf(const DistributionRun::Name& name,
                  const ScanPair& pair,
                  const PaperRun& run,
                  const PaperBaseline& baseline);

/** \brief A pair with its baseline and the runs of all methods, as many of each as
 * there are repeats, in the order of paperMethods(). */
struct PairDistribution {
  const ScanPair* pair = nullptr;
  PaperBaseline baseline;
  std::vector<DistributionRun> runs;
};

/** \brief Take from the files what is there and make the rest. */
PairDistribution
studyDistribution(const PaperStudy& study,
                  const PaperProblem& problem,
                  DistributionFile& file);

} // namespace bayesian_icp::evaluate
