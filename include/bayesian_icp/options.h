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
  /** A likelihood whose scale and correlations are found from the clouds: distances to
   * the target's surface in units of its own noise, and a covariance that is that of
   * the robust estimate. Motions that the clouds do not hold stay at the prior. */
  Calibrated
};

/** \brief The preset of whoever does not choose one. */
constexpr Preset default_preset = Preset::Calibrated;

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

/** \brief What only preset `calibrated` has. */
struct CalibratedOptions {
  /** Largest number of source points that are used; of a larger source so many that
   * cover it evenly. Time is proportional to it. At least min_calibrated_points. */
  int max_source_points = 2000;
  /** Of these, points on which the starts are followed to their modes. At least
   * min_calibrated_points; more than there are is taken as all. */
  int num_mode_points = 500;
};

/** \brief Fewest points of a cloud with which preset `calibrated` can do anything:
 * those of one neighbourhood of its surface model. */
constexpr int min_calibrated_points = 30;

/** \brief Options of the estimate; defaults of numbers are the paper's.
 *
 * Preset `exact` finds mini_batch.batch_size, sgld.step_size, chains.num_burn_in and
 * chains.thinning itself where they have their defaults; any other value is obeyed
 * (step_size in (0, 1] is then the largest step, 1 a Newton step). Its chains start
 * chains.initial_spread about the initial guess; where that is zero, as widely as the
 * prior allows, but at most 0.5 m and 0.5 rad. It draws its mini-batches without
 * replacement and uses no other field of sgld.
 *
 * Preset `calibrated` finds its scale, step sizes and starts itself: it uses prior,
 * whose variances must be finite, chains but for chains.initial_spread, and calibrated;
 * all else has no effect on it. chains.num_burn_in and chains.thinning are automatic
 * where they have their defaults. It starts at the prior's mean. */
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
   * \return what is wrong with the first bad one: its name, its value and the allowed
   *         range. Empty if all is well. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief The frame of the prior of a run: prior.frame, or what Automatic stands for.
 *
 * Automatic is Origin for presets `paper` and `exact`. For `calibrated` it is Origin if
 * the origin of the source frame is no further from the source's centroid than 1.5
 * times the points' root mean square distance from it: such a cloud is a scan, and a
 * guess about it errs by a motion of the sensor. Other clouds are objects that a sensor
 * looks at, and their frame is SourceCentroid.
 * \param[in] options of the run
 * \param[in] source_points of the run, source frame [m]; those not finite do not count
 */
BAYESIAN_ICP_EXPORT PriorFrame
priorFrameOf(const Options& options, const Eigen::Matrix3Xd& source_points);

/** \brief The prior of a run.
 * \param[in] options of the run
 * \param[in] initial_pose its guess, which is the mean of a prior that has none
 * \param[in] source_points of the run, source frame [m]; those not finite do not count
 */
BAYESIAN_ICP_EXPORT Prior
priorOf(const Options& options,
        const Vector6d& initial_pose,
        const Eigen::Matrix3Xd& source_points);

} // namespace bayesian_icp
