/** \file
 * \brief The samplers that are compared, each run once on a problem.
 */
#pragma once

#include "sampler/chain_set.h"
#include "samplers/sampler_problem.h"

#include <bayesian_icp/summary.h>

#include <cstdint>
#include <optional>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief What a sampler made. */
struct SamplerRun {
  ChainSet chains;
  /** Of a preset; other samplers have none. */
  std::optional<Summary> summary;
  /** Short name of the Status; empty: as the draws show. */
  std::string status;
  /** CPU time from the first to the last step, warm-up included, of all threads [s]. */
  double seconds = 0.0;
  /** Not empty if the sampler refused to run, or says more than the draws show. */
  std::string message;
};

/** \brief A Gaussian that competitors get for nothing: from the gold standard. */
struct Oracle {
  /** Lower triangular; factor factor^T is the covariance of the centred pose. */
  Matrix6d factor;
  /** Centred poses to start from, spread over the density. */
  PoseMatrix starts;
};

Oracle
oracleOf(const Problem& problem, const GoldStandard& gold);

/** \brief What the library makes of two clouds.
 * \param[in] start mean of the prior unless the options state one, and of the chains'
 *            starts [m, rad] */
SamplerRun
runPreset(const Eigen::Matrix3Xd& source,
          const KdTree& target,
          const Options& options,
          const Vector6d& start = Vector6d::Zero());

/** \brief Preset `exact` with these steps.
 * \param[in] num_particles of Stein steps */
SamplerRun
runExact(const Problem& problem,
         std::uint64_t seed,
         int num_threads,
         ExactSteps steps,
         int num_particles = ExactOptions().num_particles);

/** \brief Algorithm 1 with a step size: 1000 steps of burn-in, every tenth step kept.
 */
SamplerRun
runPaper(const Problem& problem, std::uint64_t seed, int num_threads, double step_size);

/** \brief Random-walk Metropolis over all points, from draws and with the covariance
 * of the gold standard. */
SamplerRun
runOracleWalk(const Problem& problem, const Oracle& oracle, std::uint64_t seed);

/** \brief MALA over all points, likewise.
 * \param[in] step squared step length in units of the covariance */
SamplerRun
runOracleMala(const Problem& problem,
              const Oracle& oracle,
              std::uint64_t seed,
              double step);

} // namespace bayesian_icp::evaluate
