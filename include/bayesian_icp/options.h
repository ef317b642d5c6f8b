/** \file
 * \brief All options of the estimate, each with its unit, range and source.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/prior.h>

#include <cstdint>
#include <limits>
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

/** \brief The type of `automatic`. */
struct AutomaticTag {};

/** \brief What an option is whose value the preset is to find itself. */
constexpr AutomaticTag automatic{};

/** \brief An option that is `automatic` or has a value. */
template <typename T>
class Automatic {
public:
  Automatic(AutomaticTag = automatic) : value_() {}
  Automatic(const T& value) : value_(value), is_given_(true) {}

  bool
  isGiven() const
  {
    return is_given_;
  }

  /** \brief The value if one is given, else \p found. */
  T
  valueOr(const T& found) const
  {
    return is_given_ ? value_ : found;
  }

private:
  T value_;
  bool is_given_ = false;
};

/** \brief Eigen leaves numbers as they are unless told otherwise. */
template <>
inline Automatic<Vector6d>::Automatic(AutomaticTag) : value_(Vector6d::Zero())
{}

/** \brief How many chains and draws, from which random numbers, on how many threads. */
struct ChainOptions {
  /** Number of independent chains, positive. */
  int num_chains = 4;
  /** Draws kept in total over all chains, at least one per chain; earlier chains take
   * the remainder. */
  int num_draws = 2000;
  /** Seed of all random numbers; chain i uses stream i of this seed. */
  std::uint64_t seed = 1;
  /** OpenMP threads, 1024 at most; 0: as OpenMP would. Draws do not depend on it. */
  int num_threads = 0;

  /** \brief Number of draws that chain \p chain keeps. */
  int
  numDrawsOf(int chain) const
  {
    return num_draws / num_chains + (chain < num_draws % num_chains ? 1 : 0);
  }
};

/** \brief Scale of the likelihood. The energy is N / sigma^2 times the mean of |p -
 * q|^2 / 2 over the source. */
struct LikelihoodScale {
  /** N of eq. (5), which is not the size of the cloud. The paper fixes it "so that a
   * single step size can be used". Positive, dimensionless. */
  double effective_points = 6000.0;
  /** sigma, standard deviation of a point-to-point distance [m]. The paper's scale is
   * implicitly 1 m. Positive. */
  double measurement_sigma = 1.0;

  /** \brief N / sigma^2 [1/m^2]. */
  double
  weight() const
  {
    return effective_points / (measurement_sigma * measurement_sigma);
  }
};

/** \brief How the source points of a mini-batch are chosen. */
enum class MiniBatchSampling {
  /** Every point of every batch is drawn independently of all others. */
  WithReplacement,
  /** The source is shuffled and dealt out in batches; it is shuffled again when fewer
   * points than a batch are left, so no point comes twice within an epoch. */
  ShuffledEpochs
};

/** \brief Short name: "with-replacement" or "shuffled-epochs". */
BAYESIAN_ICP_EXPORT const char*
toString(MiniBatchSampling sampling);

/** \brief Constants of Algorithm 1. */
struct SgldOptions {
  /** alpha of eqs. (5), (8), (9); dimensionless, positive. */
  double step_size = 1e-4;
  /** beta of eq. (10): share of the old squared gradient that is kept each step, in
   * [0, 1). */
  double decay_rate = 0.9;
  /** lambda of eq. (11), which keeps the preconditioner finite. Added to the root mean
   * square of the mean gradient, so in its units [m, m^2/rad]. Positive. */
  double lambda_rms = 1e-8;
  /** Factor on the variance of the injected noise of eq. (5): "adjust_noise" of the
   * authors' program. With other than 1 the chain does not sample the posterior. Not
   * negative. */
  double noise_factor = 1.0;
  /** Block decay of the step size "towards the end of sampling": from the step
   * block_decay_start * (steps of the chain) on, alpha is multiplied by
   * block_decay_factor every block_decay_interval steps. Factor in (0, 1], 1 is off;
   * interval in steps, positive; start as a fraction in [0, 1]. */
  double block_decay_factor = 0.8;
  int block_decay_interval = 10;
  double block_decay_start = 0.95;
};

/** \brief Options of preset `paper`. Default numbers are the paper's. */
struct PaperOptions {
  LikelihoodScale scale;
  /** m of Algorithm 1, number of source points in each step. Positive; if it exceeds
   * the size of the source, the whole source is used. */
  int batch_size = 160;
  MiniBatchSampling sampling = MiniBatchSampling::WithReplacement;
  SgldOptions sgld;
  /** Gate on the distance of corresponding points [m]. Positive; infinity means no
   * gate. A search of the user's own has its own gate. */
  double max_distance = std::numeric_limits<double>::infinity();
  /** Steps at the start of each chain that are not kept. */
  int num_burn_in = 0;
  /** Steps per kept draw, in each chain; positive. */
  int thinning = 1;
  /** Standard deviation of the chains' starts about the initial guess
   * (x, y, z, roll, pitch, yaw) [m, rad]; zero starts every chain at the guess. */
  Vector6d initial_spread = Vector6d::Zero();
};

/** \brief Definition of the residual r, whose energy is rho(r). */
enum class Residual {
  /** Distance of the moved source point to the nearest target point. */
  PointToPoint,
  /** Distance along the target's normal at the nearest target point. Its energy jumps
   * where the nearest point changes, so only Metropolis steps are exact for it. */
  PointToPlane,
  /** r^2 = d^T (C_target + R C_source R^T)^-1 d for the vector d to the nearest target
   * point (A. Segal, D. Haehnel, S. Thrun: Generalized-ICP, RSS 2009). C is the
   * covariance of a point's neighbourhood in its own cloud, regularised and scaled as
   * CovarianceRegularization says: where both surfaces are planes with the same normal,
   * r is the distance along it, as with PointToPlane, and measurement_sigma [m] is the
   * standard deviation of that distance. The energy has no log-determinant, as in
   * GICP, and jumps as that of PointToPlane does. */
  DistributionToDistribution
};

/** \brief How the covariance of a neighbourhood becomes the C of
 * Residual::DistributionToDistribution. C is dimensionless. Its least eigenvalue is
 * 1/2, the share of one of two clouds along a common normal, unless said otherwise. */
enum class CovarianceRegularization {
  /** Eigenvalues (1, 1, 1e-3) / 2e-3: every neighbourhood is a plane, and a distance
   * within two such planes counts 1/31.6 of one along their normal (Segal et al.). */
  Plane,
  /** Covariance + 1e-3 m^2, scaled so that the Frobenius norm of the inverse is 2:
   * neighbourhoods that are not flat stay so (fast_gicp). The least eigenvalue is 1/2
   * for a wide plane, and up to sqrt(3) / 2 for what is narrower than 3 cm. */
  Frobenius,
  /** The covariance as it is, scaled only. Eigenvalues below 1e-6 of the largest are
   * raised to that. */
  None
};

/** \brief The function rho. */
enum class RobustKernel {
  /** r^2 / 2. */
  None,
  /** r^2 / 2 up to the width k, and k (r - k/2) beyond it. */
  Huber,
  /** Tukey's biweight: k^2/6 (1 - (1 - (r/k)^2)^3) up to the width k, and k^2/6 beyond
   * it. */
  Tukey
};

/** \brief Short name: "point-to-point", "point-to-plane" or
 * "distribution-to-distribution". */
BAYESIAN_ICP_EXPORT const char*
toString(Residual residual);

/** \brief Short name: "plane", "frobenius" or "none". */
BAYESIAN_ICP_EXPORT const char*
toString(CovarianceRegularization regularization);

/** \brief Short name: "none", "huber" or "tukey". */
BAYESIAN_ICP_EXPORT const char*
toString(RobustKernel kernel);

/** \brief Residual, kernel and gate of the preset `exact`. */
struct ResidualOptions {
  Residual residual = Residual::PointToPoint;
  /** Used by Residual::DistributionToDistribution alone. */
  CovarianceRegularization regularization = CovarianceRegularization::Plane;
  RobustKernel kernel = RobustKernel::None;
  /** Width k of the kernel [m], positive. Not used by RobustKernel::None. */
  double kernel_width = 0.01;
  /** d_max, the gate on the distance to the nearest target point [m]. Positive;
   * infinity means no gate. A point without a target point within the gate contributes
   * rho(d_max). A search of the user's own has its own gate: set this value to the
   * same one. */
  double max_distance = std::numeric_limits<double>::infinity();
};

/** \brief How preset `exact` makes draws after its warm-up. */
enum class ExactSteps {
  /** Metropolis where the gradient of a batch is so noisy that Langevin steps would
   * need (nearly) all terms; Langevin elsewhere. */
  Automatic,
  Langevin,
  /** Asymptotically exact. Each step evaluates the whole source. */
  Metropolis,
  /** Stein variational gradient descent (Q. Liu, D. Wang, NIPS 2016; F. Afzal Maken, F.
   * Ramos, L. Ott: Stein ICP, 2021): the draws are particles that repel each other.
   * Status::Ok if their kernelised Stein discrepancy says so; there is no R-hat. */
  SteinGradient,
  /** Stein variational Newton steps (G. Detommaso et al., NeurIPS 2018) of the same
   * particles. */
  SteinNewton
};

/** \brief Whether the draws are particles, not chains. */
constexpr bool
usesParticles(ExactSteps steps)
{
  return steps == ExactSteps::SteinGradient || steps == ExactSteps::SteinNewton;
}

/** \brief Short name: "automatic", "langevin", "metropolis", "stein-gradient",
 * "stein-newton". */
BAYESIAN_ICP_EXPORT const char*
toString(ExactSteps steps);

/** \brief Smallest number of Stein particles: fewer have no covariance. */
constexpr int min_particles = 8;

/** \brief Options of preset `exact`. Its mini-batches are drawn without replacement. */
struct ExactOptions {
  LikelihoodScale scale;
  ResidualOptions residual;
  ExactSteps steps = ExactSteps::Automatic;
  /** Number of Stein particles, which replaces ChainOptions::num_draws: at least
   * min_particles and num_chains, among which they are divided. */
  int num_particles = 100;
  /** Source points in each Langevin step, positive. With a value, automatic steps are
   * Langevin steps, and all others are excluded. */
  Automatic<int> batch_size;
  /** Largest size of a Langevin step, in (0, 1]; 1 would be a Newton step. Longer steps
   * bias the draws of a rough density: docs/performance.md. */
  double max_step_size = 0.6;
  /** Steps of each chain after its warm-up that are not kept. */
  Automatic<int> num_burn_in;
  /** Steps per kept draw, in each chain; positive. Automatic makes draws nearly
   * independent. */
  Automatic<int> thinning;
  /** Standard deviation of the chains' starts about the initial guess
   * (x, y, z, roll, pitch, yaw) [m, rad]. Automatic is the prior's, but at most 0.5 m
   * and 0.5 rad. */
  Automatic<Vector6d> initial_spread;
  /** Largest number of source points that are used; a larger source is thinned to it,
   * evenly over its order. The energy is N / sigma^2 times a mean over the source, and
   * some thousand points give that mean; more points only take longer. Not applied
   * with a search of the user's own, which knows points by their index. Positive. */
  int max_source_points = 4000;
};

/** \brief Options of preset `calibrated`. It finds scale, steps and starts itself. */
struct CalibratedOptions {
  /** Largest number of source points that are used, and of target points, which are
   * compared with the source's surface. Of a larger cloud, points that cover it evenly:
   * this many, but beyond 2000 no more than 40 % of it, or of the other cloud's points.
   * Starts and curvature use 2000 points. At least min_calibrated_points. */
  int max_source_points = 4000;
  /** Number of these points that are used to follow the starts to their modes. At least
   * min_calibrated_points; if it exceeds the number of points, all are used. */
  int num_mode_points = 500;
  /** Steps at the start of each chain that are not kept. */
  Automatic<int> num_burn_in;
  /** Steps per kept draw, in each chain; positive. */
  Automatic<int> thinning;
};

/** \brief Smallest number of points of a cloud for preset `calibrated`: one
 * neighbourhood of its surface model. */
constexpr int min_calibrated_points = 30;

/** \brief Options of the estimate: what all presets share, and those of each preset. */
struct Options {
  Preset preset = default_preset;
  /** Preset `calibrated` needs finite variances, and searches from the mean. */
  PriorOptions prior;
  ChainOptions chains;
  PaperOptions paper;
  ExactOptions exact;
  CalibratedOptions calibrated;

  /** \brief Check what all presets share and the options of the chosen one.
   * \return the first error: the name of the field, its value and the allowed range.
   * Empty if all these fields are valid. */
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
