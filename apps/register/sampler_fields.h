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
  visit({"chains", "num_chains", "chains", "N", "Number of independent chains."},
        chains.num_chains);
  visit({"chains",
         "num_draws",
         "samples",
         "N",
         "Number of draws to keep, over all chains."},
        chains.num_draws);
  visit({"chains",
         "num_burn_in",
         "burn-in",
         "N",
         "Number of steps at the start of each chain that are not kept. Presets exact "
         "and calibrated replace the default by a number of their own."},
        chains.num_burn_in);
  visit({"chains",
         "thinning",
         "thinning",
         "N",
         "Number of steps for each kept draw. Presets exact and calibrated replace the "
         "default by a number of their own."},
        chains.thinning);
  visit({"chains",
         "initial_spread_m_rad",
         "initial-spread",
         "LIST",
         "Standard deviation of the chains' starts about the guess, "
         "x,y,z,roll,pitch,yaw [m, rad]: six numbers, or one for all. With preset "
         "exact, 0 means as wide as the prior, but at most 0.5."},
        chains.initial_spread);
  visit({"chains", "seed", "seed", "N", "Seed of all random numbers, 0 to 2^64-1."},
        chains.seed);
  visit({"chains",
         "num_threads",
         "threads",
         "N",
         "Number of threads. 0 means as many as there are. The draws do not depend on "
         "it."},
        chains.num_threads);
  visit({"mini_batch",
         "batch_size",
         "batch-size",
         "N",
         "Number of source points in each step. Preset exact replaces the default by a "
         "number of its own."},
        options.mini_batch.batch_size);
  visit({"mini_batch",
         "sampling",
         "batch-sampling",
         "NAME",
         "How the source points of a step are chosen. Preset exact does not use it."},
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
         "Step size alpha of eqs. (5), (8), (9). Preset exact replaces the default by "
         "a value of its own."},
        sgld.step_size);
  visit({"sgld",
         "decay_rate",
         "decay-rate",
         "B",
         "Share beta of the old squared gradient that eq. (10) keeps."},
        sgld.decay_rate);
  visit({"sgld",
         "lambda_rms",
         "lambda-rms",
         "L",
         "Constant lambda of eq. (11), which keeps the preconditioner finite [m, "
         "m^2/rad]."},
        sgld.lambda_rms);
  visit({"sgld",
         "noise_factor",
         "noise-factor",
         "F",
         "Factor on the variance of the injected noise."},
        sgld.noise_factor);
  visit({"sgld",
         "block_decay_factor",
         "block-decay-factor",
         "F",
         "Multiply the step size by F every --block-decay-interval steps at the end of "
         "a chain. 1 turns this off."},
        sgld.block_decay_factor);
  visit({"sgld",
         "block_decay_interval",
         "block-decay-interval",
         "N",
         "Number of steps between two reductions of the step size."},
        sgld.block_decay_interval);
  visit({"sgld",
         "block_decay_start",
         "block-decay-start",
         "P",
         "Where these reductions begin, as a fraction of the steps of a chain."},
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
