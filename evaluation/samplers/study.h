/** \file
 * \brief One problem, all samplers: runs what is not in the result file yet.
 */
#pragma once

#include "samplers/samplers_options.h"
#include "samplers/score.h"

#include <functional>

namespace bayesian_icp::evaluate {

/** \brief Runs the samplers on one problem. */
class Study {
public:
  using Report = std::function<void(const std::string&)>;

  /** All arguments must outlive this object.
   * \param[in] report gets lines of progress */
  Study(const Problem& problem,
        const SamplersOptions& options,
        ResultFile& results,
        const Report& report);

  /** \brief Make the gold standard or read it, and run what is missing.
   * \return whether the gold standard has converged */
  bool
  run();

private:
  using Sampler = std::function<SamplerRun(std::uint64_t seed)>;

  /** One run, from the file if it is there. */
  Score
  runOnce(const std::string& name, std::uint64_t seed, const Sampler& sampler);

  void
  runAllSeeds(const std::string& name, const Sampler& sampler);

  void
  runPaperSteps();

  void
  runMalaSteps(const Oracle& oracle);

  const Problem& problem_;
  const SamplersOptions& options_;
  ResultFile& results_;
  const Report& report_;
  PoseMatrix gold_draws_;
};

} // namespace bayesian_icp::evaluate
