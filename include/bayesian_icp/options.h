/** \file
 * \brief All options of the estimate in one place, each with its unit, range and
 * source.
 */
#pragma once

#include <bayesian_icp/chains.h>
#include <bayesian_icp/likelihood.h>
#include <bayesian_icp/mini_batch.h>
#include <bayesian_icp/prior.h>
#include <bayesian_icp/sgld.h>

#include <string>

namespace bayesian_icp {

/** \brief Which posterior is sampled, and how. */
enum class Preset {
  /** Algorithm 1 of the paper, literally: a reproduction. Its covariance has an
   * implicit measurement_sigma of 1 m. */
  Paper,
  /** A sampler whose draws are right for the stated options. Not available yet. */
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

/** \brief Options of the estimate; the defaults are the preset `paper`. */
struct Options {
  Preset preset = Preset::Paper;
  LikelihoodOptions likelihood;
  PriorOptions prior;
  MiniBatchOptions mini_batch;
  SgldOptions sgld;
  ChainOptions chains;

  /** \brief Check every field.
   * \return what is wrong with the first bad one: its name, its value and the allowed
   *         range. Empty if all is well. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

} // namespace bayesian_icp
