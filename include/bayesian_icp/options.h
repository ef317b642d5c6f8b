/** \file
 * \brief All options of the estimate in one place, each with its unit, range and
 * source.
 */
#pragma once

#include <bayesian_icp/chains.h>
#include <bayesian_icp/likelihood.h>
#include <bayesian_icp/mini_batch.h>
#include <bayesian_icp/preconditioned_sampler.h>
#include <bayesian_icp/prior.h>
#include <bayesian_icp/residual.h>
#include <bayesian_icp/sgld.h>

#include <string>

namespace bayesian_icp {

/** \brief Which posterior is sampled, and how. */
enum class Preset {
  /** Algorithm 1 of the paper, literally: a reproduction. Its covariance has an
   * implicit measurement_sigma of 1 m. */
  Paper,
  /** A sampler whose draws are right for the stated likelihood and prior. */
  Exact,
  /** A likelihood whose scale is found from the data. Not available yet. */
  Calibrated
};

/** \brief Short name: "paper", "exact", "calibrated". */
BAYESIAN_ICP_EXPORT const char*
toString(Preset preset);

/** \brief Mini-batches of Algorithm 1. */
struct MiniBatchOptions {
  /** m, number of source points a step; positive, more than the source has is taken as
   * all of it. */
  int batch_size = 160;
  MiniBatchSampling sampling = MiniBatchSampling::WithReplacement;
};

/** \brief What preset `exact` has and the paper has not. */
struct ExactOptions {
  ResidualOptions residual;
  /** Metropolis steps in place of Langevin steps: asymptotically exact, each looks at
   * the whole source. Automatic uses them where Langevin steps would need mini-batches
   * of (nearly) the whole source; never if mini_batch.batch_size or sgld.step_size are
   * set, which are of Langevin steps. */
  MetropolisUse metropolis = MetropolisUse::Automatic;
  /** Largest number of source points that are used; a larger source is thinned to it,
   * evenly over its order. The energy is N / sigma^2 times a mean over the source,
   * which some thousand points give; more only take longer. Not with a search of the
   * user's own, which knows points by their index. Positive. */
  int max_source_points = 4000;
};

/** \brief Options of the estimate; the defaults are the preset `paper`.
 *
 * Preset `exact` finds mini_batch.batch_size, sgld.step_size, chains.num_burn_in and
 * chains.thinning itself where they have their defaults; any other value is obeyed
 * (step_size in (0, 1] is then the largest step, 1 a Newton step). Its chains start
 * chains.initial_spread about the initial guess; where that is zero, as widely as the
 * prior allows, but at most 0.5 m and 0.5 rad. It draws its mini-batches without
 * replacement and uses no other field of sgld. */
struct Options {
  Preset preset = Preset::Paper;
  LikelihoodOptions likelihood;
  PriorOptions prior;
  MiniBatchOptions mini_batch;
  SgldOptions sgld;
  ChainOptions chains;
  ExactOptions exact;

  /** \brief Check every field.
   * \return what is wrong with the first bad one: its name, its value and the allowed
   *         range. Empty if all is well. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

} // namespace bayesian_icp
