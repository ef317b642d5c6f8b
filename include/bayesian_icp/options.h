/** \file
 * \brief All options of the estimate, each with its unit, range and source.
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
  /** A sampler that draws correctly from the posterior of the stated likelihood and
   * prior. */
  Exact,
  /** A likelihood whose scale and correlations are estimated from the clouds. Residuals
   * are distances to the target's surface in units of its own noise, and the
   * covariance is that of the robust estimate. Motions that the clouds do not
   * determine stay at the prior. */
  Calibrated
};

/** \brief The default preset. */
constexpr Preset default_preset = Preset::Calibrated;

/** \brief Short name: "paper", "exact", "calibrated". */
BAYESIAN_ICP_EXPORT const char*
toString(Preset preset);

/** \brief Mini-batches of Algorithm 1. */
struct MiniBatchOptions {
  /** m, number of source points in each step. Positive; if it exceeds the size of the
   * source, the whole source is used. */
  int batch_size = 160;
  MiniBatchSampling sampling = MiniBatchSampling::WithReplacement;
};

/** \brief Options of preset `exact` that Algorithm 1 does not have. */
struct ExactOptions {
  ResidualOptions residual;
  /** Metropolis steps instead of Langevin steps. They are asymptotically exact, and
   * each step evaluates the whole source. Automatic uses them where Langevin steps
   * would need mini-batches of (nearly) the whole source. It never uses them if
   * mini_batch.batch_size or sgld.step_size is set, because these are options of
   * Langevin steps. */
  MetropolisUse metropolis = MetropolisUse::Automatic;
  /** Largest number of source points that are used; a larger source is thinned to it,
   * evenly over its order. The energy is N / sigma^2 times a mean over the source, and
   * some thousand points give that mean; more points only take longer. Not applied
   * with a search of the user's own, which knows points by their index. Positive. */
  int max_source_points = 4000;
};

/** \brief Options of preset `calibrated`. */
struct CalibratedOptions {
  /** Largest number of source points that are used; of a larger source, this many
   * points that cover it evenly. Time is proportional to it. At least
   * min_calibrated_points. */
  int max_source_points = 2000;
  /** Number of these points that are used to follow the starts to their modes. At least
   * min_calibrated_points; if it exceeds the number of points, all are used. */
  int num_mode_points = 500;
};

/** \brief Smallest number of points of a cloud for preset `calibrated`: one
 * neighbourhood of its surface model. */
constexpr int min_calibrated_points = 30;

/** \brief Options of the estimate. Default numbers are the paper's.
 *
 * Preset `exact` chooses mini_batch.batch_size, sgld.step_size, chains.num_burn_in and
 * chains.thinning automatically if they have their defaults, and obeys any other value
 * (step_size in (0, 1] is then the largest step; 1 is a Newton step). Its chains start
 * with the spread chains.initial_spread about the initial guess. If that is zero, they
 * start as widely as the prior allows, but at most 0.5 m and 0.5 rad. Mini-batches are
 * drawn without replacement. No other field of sgld has an effect.
 *
 * Preset `calibrated` finds its scale, step sizes and starts itself. It uses prior
 * (whose variances must be finite), chains without chains.initial_spread, and
 * calibrated. All other options have no effect. chains.num_burn_in and chains.thinning
 * are automatic if they have their defaults. The search starts at the prior's mean. */
struct Options {
  Preset preset = default_preset;
  LikelihoodOptions likelihood;
  PriorOptions prior;
  MiniBatchOptions mini_batch;
  SgldOptions sgld;
  ChainOptions chains;
  ExactOptions exact;
  CalibratedOptions calibrated;

  /** \brief Check every field.
   * \return the first error: the name of the field, its value and the allowed range.
   * Empty if all fields are valid. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief Resolve the frame of the prior.
 *
 * Automatic is Origin for presets `paper` and `exact`. For `calibrated` it is Origin if
 * the source's centroid is no further from the origin than 1.5 times the points' root
 * mean square distance from the centroid: such a cloud is a scan, and the error of its
 * guess is a motion of the sensor. Other clouds are objects, and their frame is
 * SourceCentroid.
 * \param[in] options options of the run
 * \param[in] source_points points of the run, source frame [m]; points that are not
 *            finite do not count
 * \return Origin or SourceCentroid */
BAYESIAN_ICP_EXPORT PriorFrame
priorFrameOf(const Options& options, const Eigen::Matrix3Xd& source_points);

/** \brief Make the prior of a run.
 * \param[in] options options of the run
 * \param[in] initial_pose guess of the run, which is the mean if prior.mean is NaN
 * \param[in] source_points points of the run, source frame [m]; points that are not
 *            finite do not count */
BAYESIAN_ICP_EXPORT Prior
priorOf(const Options& options,
        const Vector6d& initial_pose,
        const Eigen::Matrix3Xd& source_points);

} // namespace bayesian_icp
