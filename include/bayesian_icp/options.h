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
  /** Reproduces Algorithm 1 of the paper literally. Its covariance has an implicit
   * measurement_sigma of 1 m. */
  Paper,
  /** Draws correctly from the posterior of the stated likelihood and prior. */
  Exact,
  /** Estimates the scale and the correlations of the likelihood from the clouds.
   * Residuals are distances to the target's surface in units of its own noise. The
   * covariance is that of the robust estimate. Motions that the clouds do not determine
   * keep the prior. */
  Calibrated
};

/** \brief The default preset. */
constexpr Preset default_preset = Preset::Calibrated;

/** \brief Short name: "paper", "exact", "calibrated". */
BAYESIAN_ICP_EXPORT const char*
toString(Preset preset);

/** \brief The type of `automatic`. */
struct AutomaticTag {};

/** \brief The value of an option that the preset determines itself. */
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

/** \brief Largest number of draws. They and their summary take about 2 GB. Their mean
 * has an error of 0.0003 standard deviations, so more draws are of no use. */
constexpr int max_draws = 10000000;

/** \brief Number of chains and draws, random seed and number of threads. */
struct ChainOptions {
  /** Number of independent chains, positive. */
  int num_chains = 4;
  /** Total number of draws kept over all chains, at least one per chain and at most
   * max_draws. The first chains keep one more if the number is not divisible by the
   * number of chains. Status::Ok needs effective sample sizes of min_ess: 1000 draws
   * usually have them, fewer than 400 never. */
  int num_draws = 2000;
  /** Seed of all random numbers; chain i uses stream i of this seed. */
  std::uint64_t seed = 1;
  /** Number of OpenMP threads; above 1024 it is 1024, and 0 means OpenMP's default.
   * Draws do not depend on it. */
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
  /** sigma, standard deviation of a point-to-point distance [m]. Implicitly 1 m in the
   * paper. Positive. */
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
  /** The source is shuffled and divided into batches. It is shuffled again when fewer
   * points than a batch are left, so no point occurs twice within an epoch. */
  ShuffledEpochs
};

/** \brief Short name: "with-replacement" or "shuffled-epochs". */
BAYESIAN_ICP_EXPORT const char*
toString(MiniBatchSampling sampling);

/** \brief Constants of Algorithm 1. */
struct SgldOptions {
  /** alpha of eqs. (5), (8), (9); dimensionless, positive. */
  double step_size = 1e-4;
  /** beta of eq. (10): share of the old squared gradient that is kept in each step, in
   * [0, 1). */
  double decay_rate = 0.9;
  /** lambda of eq. (11), which keeps the preconditioner finite. It is added to the root
   * mean square of the mean gradient and has its units [m, m^2/rad]. Positive. */
  double lambda_rms = 1e-8;
  /** Factor on the variance of the injected noise of eq. (5): "adjust_noise" of the
   * authors' program. With a value other than 1, the chain does not sample the
   * posterior. Not negative. */
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
  /** m of Algorithm 1, the number of source points in each step. Positive. If it
   * exceeds the size of the source, the whole source is used. */
  int batch_size = 160;
  MiniBatchSampling sampling = MiniBatchSampling::WithReplacement;
  SgldOptions sgld;
  /** Gate on the distance of corresponding points [m]. Positive; infinity means no
   * gate. A user-defined search has its own gate. */
  double max_distance = std::numeric_limits<double>::infinity();
  /** Steps at the start of each chain that are not kept. */
  int num_burn_in = 0;
  /** Steps per kept draw, in each chain; positive. */
  int thinning = 1;
  /** Standard deviation of the chains' starts about the initial guess (x, y, z, roll,
   * pitch, yaw) [m, rad]. With zero, every chain starts at the guess. */
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
   * CovarianceRegularization describes. If both surfaces are planes with the same
   * normal, r is the distance along it, as with PointToPlane, and measurement_sigma [m]
   * is the standard deviation of that distance. The energy has no log-determinant, as
   * in GICP, and jumps like that of PointToPlane. */
  DistributionToDistribution
};

/** \brief How the covariance of a neighbourhood becomes the C of
 * Residual::DistributionToDistribution. C is dimensionless. Unless stated otherwise,
 * its smallest eigenvalue is 1/2, so that each of the two clouds contributes half along
 * a common normal. */
enum class CovarianceRegularization {
  /** Eigenvalues (1, 1, 1e-3) / 2e-3: every neighbourhood is treated as a plane, and a
   * distance within two such planes counts 1/31.6 of a distance along their normal
   * (Segal et al.). */
  Plane,
  /** Covariance + 1e-3 m^2, scaled so that the Frobenius norm of the inverse is 2
   * (fast_gicp). Neighbourhoods that are not flat stay so. The smallest eigenvalue is
   * 1/2 for a wide plane, and up to sqrt(3) / 2 for neighbourhoods narrower than 3 cm.
   */
  Frobenius,
  /** The covariance, only scaled. Eigenvalues below 1e-6 of the largest are raised to
   * that value. */
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
   * rho(d_max). A user-defined search has its own gate: set this value to the same
   * distance. */
  double max_distance = std::numeric_limits<double>::infinity();
};

/** \brief How preset `exact` makes draws after its warm-up. */
enum class ExactSteps {
  /** Metropolis if the gradient of a batch is so noisy that Langevin steps would need
   * (nearly) all terms, Langevin otherwise. */
  Automatic,
  Langevin,
  /** Asymptotically exact. Each step evaluates the whole source. */
  Metropolis,
  /** Stein variational gradient descent (Q. Liu, D. Wang, NIPS 2016; F. Afzal Maken, F.
   * Ramos, L. Ott: Stein ICP, 2021): the draws are particles that repel each other.
   * There is no R-hat; Status::Ok depends on their kernelised Stein discrepancy. */
  SteinGradient,
  /** Stein variational Newton steps (G. Detommaso et al., NeurIPS 2018) with the same
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
  /** Number of Stein particles, which replaces ChainOptions::num_draws. At least
   * min_particles and at least num_chains; the particles are divided among the chains.
   */
  int num_particles = 100;
  /** Number of source points in each Langevin step, positive. If a value is given,
   * automatic steps are Langevin steps, and other kinds of steps are not allowed. */
  Automatic<int> batch_size;
  /** Largest size of a Langevin step, in (0, 1]; 1 is a Newton step. Longer steps bias
   * the draws of a rough density: docs/lab/performance.md. */
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
  /** Largest number of source points that are used, positive. A larger source is
   * thinned to this number, evenly over its order. The energy is N / sigma^2 times a
   * mean over the source. A few thousand points determine that mean, and more only take
   * longer. Not applied to a user-defined search, which knows points by their index. */
  int max_source_points = 4000;
};

/** \brief Options of preset `calibrated`. It finds scale, steps and starts itself. */
struct CalibratedOptions {
  /** Largest number of points that are used of each cloud (target points are compared
   * with the source's surface). The chosen points cover the cloud evenly. Beyond 2000
   * points, at most 40 % of the cloud's points and 0.4 per patch of the other cloud are
   * used; beyond 250 points, at most one per patch. Starts and curvature use 2000
   * points. Up to a fifth as many come on top where only they hold a motion, like that
   * along a tunnel. At least min_calibrated_points. */
  int max_source_points = 4000;
  /** Number of these points with which the starts are followed to their modes. At least
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

/** \brief Options of the estimate: those that all presets share, and those of each
 * preset. */
struct Options {
  Preset preset = default_preset;
  /** Preset `calibrated` needs finite variances, and starts its search at the mean. */
  PriorOptions prior;
  ChainOptions chains;
  PaperOptions paper;
  ExactOptions exact;
  CalibratedOptions calibrated;

  /** \brief Check the shared options and those of the chosen preset.
   * \return the first error: the name of the field, its value and the allowed range.
   * Empty if all these fields are valid. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief Resolve the frame of the prior.
 *
 * Automatic is Origin for presets `paper` and `exact`. For `calibrated` it is Origin if
 * the source's centroid is no further from the origin than 5 times the points' root
 * mean square distance from the centroid: such a cloud is a scan, and the error of its
 * guess is a motion of the sensor. Otherwise the cloud is an object, and the frame is
 * SourceCentroid.
 * \param[in] options options of the run
 * \param[in] source_points points of the run, source frame [m]; non-finite points are
 *            ignored
 * \return Origin or SourceCentroid */
BAYESIAN_ICP_EXPORT PriorFrame
priorFrameOf(const Options& options, const Eigen::Matrix3Xd& source_points);

/** \brief Make the prior of a run.
 * \param[in] options options of the run
 * \param[in] initial_pose guess of the run, which is the mean if prior.mean is NaN
 * \param[in] source_points points of the run, source frame [m]; non-finite points are
 *            ignored */
BAYESIAN_ICP_EXPORT Prior
priorOf(const Options& options,
        const Vector6d& initial_pose,
        const Eigen::Matrix3Xd& source_points);

} // namespace bayesian_icp
