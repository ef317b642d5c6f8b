/** \file
 * \brief Summary of the draws: mean pose, covariance, quantiles, diagnostics, status.
 */
#pragma once

#include <bayesian_icp/data_report.h>
#include <bayesian_icp/draws.h>
#include <bayesian_icp/export.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief Whether the posterior can be trusted, and if not, why. */
enum class Status {
  /** Nothing has been estimated yet. */
  NotRun,
  /** Every R-hat <= 1.01 and every bulk and tail ESS >= 400. For Stein particles: their
   * discrepancy is at most max_stein_discrepancy. */
  Ok,
  /** As Ok, but with a warning: the message has the reason. Flags of Summary::data
   * (preset `calibrated`) are some of the reasons. Others are, for example, coordinates
   * that 32 bits keep too coarsely, a pitch of +-90 degrees, and a kernel that leaves
   * out nearly all points (`exact`). The draws are good draws from a posterior that may
   * be wrong. */
  Doubtful,
  /** Some R-hat > 1.01, or some bulk or tail ESS < 400, or one of them is undefined.
   * For Stein particles: their discrepancy is too large. Mean and covariance describe
   * the draws, but may not describe the posterior. */
  NotMixed,
  /** The chains are in modes between which they do not move: see Summary::modes. Mean
   * and covariance of all draws mix the modes in proportion to their draws. With preset
   * `exact`, this is the proportion of their chains, not of their weights. */
  SeveralModes,
  /** At least one chain ran away, became non-finite, or jumped by more than half a turn
   * in most of its steps (white noise on the circle). Samples, mean and covariance
   * leave out its draws. */
  Diverged,
  /** The callback stopped the run. The draws until then are available. In files and
   * texts: "interrupted". */
  Cancelled,
  /** At the initial guess, too few source points have a target point within the maximum
   * correspondence distance or, with preset `calibrated`, lie on a usable surface of
   * the target. Nothing was drawn. */
  TooFewCorrespondences,
  /** An option is outside its range. Nothing was drawn. */
  InvalidOptions,
  /** The clouds, their indices or the guess cannot be used. Nothing was drawn. */
  InvalidInput
};

/** \brief Short name of a status: "ok", "doubtful", "too_few_correspondences", ...;
 * that of Cancelled is "interrupted". */
BAYESIAN_ICP_EXPORT const char*
toString(Status status);

/** \brief Whether mean and covariance describe a single posterior, well or badly: true
 * for Ok, Doubtful and NotMixed. */
BAYESIAN_ICP_EXPORT bool
hasUsableMean(Status status);

/** \brief Chains count as mixed with R-hat up to this value, and with bulk and tail
 * effective sample sizes of at least min_ess (Vehtari et al. 2021). */
constexpr double max_rhat = 1.01;
constexpr double min_ess = 400.0;

/** \brief Largest kernelised Stein discrepancy (sampler/stein.h) at which Stein
 * particles count as converged. It is the value that min_ess exact draws of a Gaussian
 * exceed in 5 % of cases. For n draws, n times its square is distributed as chi^2(6) +
 * 2 chi^2(21): the error of the mean and the errors of the 21 elements of the
 * covariance. The 95 % quantile of this sum is 72.0. */
constexpr double max_stein_discrepancy = 0.424;

/** \brief Marginal posterior of one pose coordinate, in metres or radians. Undefined
 * numbers are NaN. Quantiles of an angle are unwrapped about its mean, so they are in
 * order even if the interval crosses +-pi. */
struct CoordinateSummary {
  /** Mean of this coordinate alone, from coordinateMeans(), not from Summary::mean. */
  double mean = std::numeric_limits<double>::quiet_NaN();
  /** Standard deviation about that mean; an angle is wrapped about it. */
  double standard_deviation = std::numeric_limits<double>::quiet_NaN();
  double quantile_2_5 = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  double quantile_97_5 = std::numeric_limits<double>::quiet_NaN();
  /** NaN for Stein particles, like the three below. */
  double rhat = std::numeric_limits<double>::quiet_NaN();
  double bulk_ess = std::numeric_limits<double>::quiet_NaN();
  double tail_ess = std::numeric_limits<double>::quiet_NaN();
  /** Monte Carlo standard error of the mean. */
  double mcse = std::numeric_limits<double>::quiet_NaN();
};

/** \brief One mode of the posterior. */
struct BAYESIAN_ICP_EXPORT Mode {
  /** Share of the posterior among the modes found, in [0, 1]. It is an estimate from a
   * Gaussian at each mode, good to a factor of a few. */
  double weight = 1.0;
  /** Mean pose of its draws [m, rad]. */
  Vector6d mean = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  /** Covariances of its draws about their mean, as Summary::covariances. */
  std::array<Matrix6d, 4> covariances;
  /** Indices of its chains. */
  std::vector<int> chains;

  Mode();

  /** \brief The covariance in \p convention. */
  const Matrix6d&
  covariance(CovarianceConvention convention) const;
};

/** \brief Posterior of the pose in numbers. */
struct BAYESIAN_ICP_EXPORT Summary {
  Status status = Status::NotRun;
  /** The status in words, with the numbers behind it. */
  std::string message = "nothing has been estimated yet";
  /** Mean pose (x, y, z, roll, pitch, yaw) [m, rad]: meanPose() of the draws. NaN
   * without draws. */
  Vector6d mean = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  /** Marginals of x, y, z, roll, pitch, yaw. */
  std::array<CoordinateSummary, 6> coordinates;
  int num_chains = 0;
  int num_diverged_chains = 0;
  /** Number of draws behind mean and covariance: those of the chains that did not
   * diverge. */
  long num_draws = 0;
  /** The modes of the chains, heaviest first. Empty for preset `paper`, which does not
   * look for modes, and for preset `calibrated` if there is only one. */
  std::vector<Mode> modes;
  /** What the clouds say about the pose (preset `calibrated`). */
  DataReport data;

  /** 6x6 covariances [m, rad], one for each CovarianceConvention in its order: the
   * second moment of the draws' poseError about the mean, with num_draws - 1 in the
   * denominator. NaN with fewer than two draws. */
  std::array<Matrix6d, 4> covariances;

  Summary();

  /** \brief The covariance in \p convention. */
  const Matrix6d&
  covariance(CovarianceConvention convention) const;
};

/** \brief Draws of the chains that did not diverge, chain after chain. */
BAYESIAN_ICP_EXPORT PoseMatrix
pooledDraws(const std::vector<Chain>& chains);

/** \brief Mean of each coordinate x, y, z, roll, pitch, yaw of \p draws on its own [m,
 * rad]. The mean of an angle is circular: atan2(mean sin, mean cos). NaN without
 * draws.
 *
 * As a pose it depends on both frames: c metres away from their origins, and with
 * angles of variance s^2, it lies about c s^2 away from the draws. */
BAYESIAN_ICP_EXPORT Vector6d
coordinateMeans(const PoseMatrix& draws);

/** \brief Mean pose of \p draws (rows are canonical poses) [m, rad]; NaN without draws.
 *
 * It is the pose M for which the sum of log(M^-1 X) over the draws X is zero: the
 * bi-invariant mean on SE(3) (Pennec and Arsigny 2012). It is the same motion of the
 * points in all frames: draws A X B have the mean A M B. If the draws spread too far,
 * there is no such mean, and coordinateMeans() is returned. This is so if they turn
 * from it by 1 rad in root mean square, or one of them by 3 rad. */
BAYESIAN_ICP_EXPORT Vector6d
meanPose(const PoseMatrix& draws);

/** \brief Second moment of the draws' poseError about \p mean, divided by (number of
 * draws - 1). NaN with fewer than two draws. */
BAYESIAN_ICP_EXPORT Matrix6d
covarianceAbout(const Vector6d& mean,
                const PoseMatrix& draws,
                CovarianceConvention convention);

} // namespace bayesian_icp
