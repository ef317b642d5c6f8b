/** \file
 * \brief The settings of the sampler: names and descriptions.
 */
#pragma once

#include "register/field.h"

namespace bayesian_icp::app {

/** \brief Call visit(field, value) for the chains and their mini-batches. */
template <typename OptionsT, typename Visitor>
void
visitChains(OptionsT& options, Visitor& visit)
{
  auto& chains = options.chains;
  visit({"chains", "num_chains", "chains", "N", "independent chains"},
        chains.num_chains);
  visit({"chains", "num_draws", "samples", "N", "draws kept, over all chains"},
        chains.num_draws);
  visit(
      {"chains",
       "num_burn_in",
       "burn-in",
       "N",
       "steps at the start of each chain that are not kept; exact and calibrated find "
       "them"},
      chains.num_burn_in);
  visit({"chains",
         "thinning",
         "thinning",
         "N",
         "steps per kept draw; exact and calibrated find them"},
        chains.thinning);
  visit(
      {"chains",
       "initial_spread_m_rad",
       "initial-spread",
       "LIST",
       "standard deviation of the chains' starts about the guess, x,y,z,roll,pitch,yaw "
       "[m, rad]: six numbers, or one for all; with exact 0 is as wide as the prior, "
       "at "
       "most 0.5"},
      chains.initial_spread);
  visit({"chains", "seed", "seed", "N", "seed of all random numbers, 0 .. 2^64-1"},
        chains.seed);
  visit({"chains",
         "num_threads",
         "threads",
         "N",
         "threads, 0 for as many as there are; the draws do not depend on it"},
        chains.num_threads);
  visit({"mini_batch",
         "batch_size",
         "batch-size",
         "N",
         "source points a step; exact finds them"},
        options.mini_batch.batch_size);
  visit({"mini_batch",
         "sampling",
         "batch-sampling",
         "NAME",
         "how the source points of a step are chosen; not used by exact"},
        options.mini_batch.sampling);
}

/** \brief Call visit(field, value) for the constants of Algorithm 1. */
template <typename SgldT, typename Visitor>
void
visitSgld(SgldT& sgld, Visitor& visit)
{
  visit({"sgld",
         "step_size",
         "step-size",
         "A",
         "alpha of eqs. (5), (8), (9); exact finds its own"},
        sgld.step_size);
  visit({"sgld",
         "decay_rate",
         "decay-rate",
         "B",
         "beta of eq. (10): share of the old squared gradient that is kept"},
        sgld.decay_rate);
  visit({"sgld",
         "lambda_rms",
         "lambda-rms",
         "L",
         "lambda of eq. (11), which keeps the preconditioner finite [m, m^2/rad]"},
        sgld.lambda_rms);
  visit({"sgld",
         "noise_factor",
         "noise-factor",
         "F",
         "factor on the variance of the injected noise"},
        sgld.noise_factor);
  visit({"sgld",
         "block_decay_factor",
         "block-decay-factor",
         "F",
         "factor on alpha every so many steps towards the end; 1 is off"},
        sgld.block_decay_factor);
  visit({"sgld",
         "block_decay_interval",
         "block-decay-interval",
         "N",
         "steps from one to the next"},
        sgld.block_decay_interval);
  visit({"sgld",
         "block_decay_start",
         "block-decay-start",
         "P",
         "where that begins, as a fraction of a chain's steps"},
        sgld.block_decay_start);
}

/** \brief Call visit(field, value) for the settings of the sampler. */
template <typename OptionsT, typename Visitor>
void
visitSampler(OptionsT& options, Visitor& visit)
{
  visitChains(options, visit);
  visitSgld(options.sgld, visit);
}

} // namespace bayesian_icp::app
