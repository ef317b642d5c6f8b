#include "exact/exact.h"

#include "algebra/decompositions.h"
#include "exact/pose_energy.h"
#include "exact/preconditioned_sampler.h"
#include "sampler/mini_batch.h"
#include "summary/estimates.h"
#include "summary/plain_text.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Points of a batch whose curvature or noise is measured. */
constexpr std::size_t probe_size = 160;
constexpr int num_burn_in_steps = 80;
/** Steps with the point-to-point curvature, and without the robust kernel: they reach
 * the surface from afar. */
constexpr int num_far_steps = 20;
/** Steps before the gain decreases. */
constexpr int num_full_steps = 40;
/** Share of the stiff point-to-point curvature near the surface. */
constexpr double near_point_share = 0.1;
constexpr double fit_point_share = 0.02;
constexpr double max_step_length = 0.5, max_step_angle = 0.3; // [m], [rad]
/** Span of the tempered Gaussian, in root mean square match distances. */
constexpr double tempered_span = 3.0;
constexpr double max_temperature = 4096.0;

Vector6d
limitStep(const Vector6d& step)
{
  const double length = step.head<3>().norm() / max_step_length;
  const double angle = step.tail<3>().norm() / max_step_angle;
  return step / std::max({1.0, length, angle});
}

/** What the chains' energies have in common besides the PoseEnergy. */
struct PoseChainSettings {
  /** Centre [m, rad] and standard deviation of the starts, centred pose. */
  Vector6d start_centre, start_spread;
  /** Source points on which energies are compared. */
  std::vector<std::size_t> fixed_batch;
  std::function<bool(const Vector6d& theta)> has_diverged;
};

/** Energy of one chain, in the centred pose: batches of source points, burn-in by
 * stochastic Gauss-Newton. */
class ChainPoseEnergy : public StochasticEnergy {
public:
  /** Both arguments must outlive this object. */
  ChainPoseEnergy(const PoseEnergy& pose_energy, const PoseChainSettings& settings)
  : pose_energy_(pose_energy)
  , settings_(settings)
  , prior_precision_(pose_energy.priorPrecision())
  , all_points_(pose_energy.allPoints())
  , workspace_(pose_energy.makeWorkspace())
  , batches_(all_points_)
  {}

  std::size_t
  numTerms() const override
  {
    return pose_energy_.numPoints();
  }

  SplitGradient
  gradient(const Vector6d& phi, std::size_t batch_size, Random& random) override
  {
    const auto batch =
        terms(phi, batches_.subset(batch_size, random), BatchTerms::Gradient);
    return {pose_energy_.weight() * batch.gradient, pose_energy_.priorGradient(phi)};
  }

  Matrix6d
  termCovariance(const Vector6d& phi, Random& random) override
  {
    const auto& indices = batches_.subset(probe_size, random);
    const auto batch = terms(phi, indices, BatchTerms::SecondMoment);
    const double m = static_cast<double>(indices.size());
    const double unbiased = m > 1.0 ? m / (m - 1.0) : 0.0;
    return pose_energy_.weight() * pose_energy_.weight() * unbiased *
           (batch.second_moment - batch.gradient * batch.gradient.transpose());
  }

  Matrix6d
  roughCurvature(const Vector6d& phi) override
  {
    const auto batch = terms(phi, settings_.fixed_batch, BatchTerms::Curvature);
    return pose_energy_.weight() *
           (batch.plane_curvature + fit_point_share * batch.point_curvature);
  }

  Matrix6d
  priorPrecision() const override
  {
    return prior_precision_;
  }

  double
  energy(const Vector6d& phi) override
  {
    return energyOf(settings_.fixed_batch, phi);
  }

  double
  fullEnergy(const Vector6d& phi) override
  {
    return energyOf(all_points_, phi);
  }

  Vector6d
  toPose(const Vector6d& phi) const override
  {
    return pose_energy_.toTheta(phi);
  }

  Vector6d
  drawStart(Random& random) override
  {
    return settings_.start_centre +
           settings_.start_spread.cwiseProduct(random.normal6());
  }

  Vector6d
  burnIn(const Vector6d& start, Random& random) override
  {
    // A direction that neither the batch nor the prior holds must not be singular.
    const Matrix6d least = 1e-6 * Matrix6d::Identity();
    Vector6d phi = start;
    for (int step = 0; step < num_burn_in_steps; ++step) {
      const bool is_far = step < num_far_steps;
      ResidualOptions residual = pose_energy_.residual();
      if (is_far) {
        residual.kernel = RobustKernel::None;
        residual.residual = Residual::PointToPoint;
      }
      const auto batch = pose_energy_.batchTerms(phi,
                                                 batches_.subset(probe_size, random),
                                                 BatchTerms::Curvature,
                                                 residual,
                                                 workspace_);
      const Matrix6d likelihood_curvature =
          is_far ? batch.point_curvature
                 : Matrix6d(batch.plane_curvature +
                            near_point_share * batch.point_curvature);
      const Matrix6d curvature =
          pose_energy_.weight() * likelihood_curvature + prior_precision_ + least;
      const Vector6d gradient =
          pose_energy_.weight() * batch.gradient + pose_energy_.priorGradient(phi);
      const double gain = 1.0 / (1.0 + 0.5 * std::max(0, step - num_full_steps));
      phi -= gain * limitStep(curvature.ldlt().solve(gradient));
    }
    return phi;
  }

  double
  initialTemperature(const Vector6d& phi, const Matrix6d& covariance) override
  {
    const double rms_distance = std::sqrt(
        terms(phi, settings_.fixed_batch, BatchTerms::Nothing).squared_distance);
    const double standard_deviation =
        std::pow(covariance.diagonal().head<3>().prod(), 1.0 / 6.0);
    double temperature = 1.0;
    while (temperature < max_temperature &&
           standard_deviation * std::sqrt(4.0 * temperature) <
               tempered_span * rms_distance)
      temperature *= 4.0;
    return temperature;
  }

  bool
  hasDiverged(const Vector6d& phi) const override
  {
    return !phi.allFinite() || settings_.has_diverged(toPose(phi));
  }

private:
  double
  energyOf(const std::vector<std::size_t>& batch, const Vector6d& phi)
  {
    return pose_energy_.weight() * terms(phi, batch, BatchTerms::Nothing).energy +
           pose_energy_.priorEnergy(phi);
  }

  BatchTerms
  terms(const Vector6d& phi,
        const std::vector<std::size_t>& batch,
        BatchTerms::Extras extras)
  {
    return pose_energy_.batchTerms(
        phi, batch, extras, pose_energy_.residual(), workspace_);
  }

  const PoseEnergy& pose_energy_;
  const PoseChainSettings& settings_;
  Matrix6d prior_precision_;
  std::vector<std::size_t> all_points_;
  EnergyWorkspace workspace_;
  MiniBatches batches_;
};

/** Largest spread of the starts that is chosen automatically [m, rad]. */
constexpr double max_automatic_spread = 0.5;

/** Smallest share of Tukey's kernel that the points together must use. A tenth of them
 * on the target's surface would use it. */
constexpr double min_used_by_kernel = 0.1;

/** Root mean square of the residuals, in units of sigma, from which on the stated sigma
 * does not fit the clouds. Noise of sigma along all three axes gives 1.7, and the
 * spacing of the target's points adds to it. */
constexpr double max_distance_in_sigmas = 3.0;

/** Source points on which the energies of modes are compared. */
constexpr std::size_t fixed_batch_size = 4000;

/** \p size of the points, evenly over their order. */
std::vector<std::size_t>
evenlySpread(std::size_t num_points, std::size_t size)
{
  size = std::min(size, num_points);
  std::vector<std::size_t> indices(size);
  for (std::size_t i = 0; i < size; ++i)
    indices[i] = i * num_points / size;
  return indices;
}

/** Mean rho of the points' residuals [m^2]. */
double
energyOfPoints(const PoseEnergy& energy, const Vector6d& pose)
{
  return (energy.energy(pose) - energy.prior().energy(pose)) / energy.weight();
}

/** Root mean square of the residuals [m] at the mean, or at one of some draws where it
 * is smaller: the mean of a curved posterior, or of several modes, may lie outside of
 * it. */
double
distanceOfBest(const PoseEnergy& energy, const PosteriorEstimate& estimate)
{
  constexpr std::size_t num_draws = 16;
  double least = energyOfPoints(energy, estimate.summary.mean);
  for (const std::size_t draw :
       evenlySpread(static_cast<std::size_t>(estimate.samples.rows()), num_draws))
    least = std::min(
        least,
        energyOfPoints(
            energy, estimate.samples.row(static_cast<Eigen::Index>(draw)).transpose()));
  return std::sqrt(2.0 * least);
}

ChainSet
sample(const PoseEnergy& energy,
       const Vector6d& initial_pose,
       const Options& options,
       const std::function<bool(const Vector6d&)>& has_diverged,
       const ProgressCallback& progress)
{
  PoseChainSettings settings;
  settings.start_centre = energy.toPhi(initial_pose);
  settings.start_spread = options.exact.initial_spread.valueOr(
      energy.prior().variance().cwiseSqrt().cwiseMin(max_automatic_spread));
  settings.fixed_batch = evenlySpread(energy.numPoints(), fixed_batch_size);
  settings.has_diverged = has_diverged;

  ChainOptions chains = options.chains;
  if (!energy.target().isThreadSafe())
    chains.num_threads = 1;
  std::vector<std::unique_ptr<StochasticEnergy>> energies;
  for (int i = 0; i < chains.num_chains; ++i)
    energies.push_back(std::make_unique<ChainPoseEnergy>(energy, settings));
  return runPreconditionedChains(std::move(energies), options.exact, chains, progress);
}

/** Root mean square distance of points from the plane that fits them best [m]. */
double
thicknessOf(const Eigen::Matrix3Xd& points)
{
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d covariance =
      centred * centred.transpose() / static_cast<double>(points.cols());
  const double least_variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues()
          .minCoeff();
  return std::sqrt(std::max(least_variance, 0.0));
}

/** \param[in] thickness of the source [m] */
std::vector<std::string>
doubtsAbout(const PoseEnergy& energy,
            const PosteriorEstimate& estimate,
            double thickness,
            double measurement_sigma)
{
  const Vector6d& mean = estimate.summary.mean;
  if (!mean.allFinite())
    return {};
  const ResidualOptions& residual = energy.residual();
  const double distance = distanceOfBest(energy, estimate);
  std::vector<std::string> doubts;
  if (distance > max_distance_in_sigmas * measurement_sigma)
    doubts.push_back(
        formatted("the source points stay %.2g m from the target (root mean square), "
                  "%.1f times measurement_sigma: they do not fit as well as was stated",
                  distance,
                  distance / measurement_sigma));
  if (thickness < distance && residual.residual == Residual::PointToPoint)
    doubts.push_back(formatted(
        "the source is a plane or a line to within %.2g m, less than the %.2g m "
        "between its points and the target's: how far it slides along is not to be "
        "seen from distances between points",
        thickness,
        distance));
  // The energy of a point beyond the kernel is largest, and the same for all.
  const double plateau =
      robustEnergy(residual, residual.kernel_width * residual.kernel_width);
  if (residual.kernel == RobustKernel::Tukey &&
      1.0 - energyOfPoints(energy, mean) / plateau < min_used_by_kernel)
    doubts.push_back(formatted(
        "the kernel of width %g m leaves out nearly all source points at the mean pose",
        residual.kernel_width));
  return doubts;
}

} // namespace

PosteriorEstimate
estimateExact(const Eigen::Matrix3Xd& source_points,
              const Target& target,
              const Prior& prior,
              const Vector6d& initial_pose,
              const Options& options,
              const std::function<bool(const Vector6d&)>& has_diverged,
              const ProgressCallback& progress)
{
  const LikelihoodScale& scale = options.exact.scale;
  const Eigen::Matrix3Xd sampled_points = source_points(
      Eigen::all,
      evenlySpread(static_cast<std::size_t>(source_points.cols()),
                   static_cast<std::size_t>(options.exact.max_source_points)));
  const PoseEnergy energy(
      sampled_points, target, prior, scale.weight(), options.exact.residual);
  PosteriorEstimate result =
      estimateOf(sample(energy, initial_pose, options, has_diverged, progress), prior);
  addDoubts(
      doubtsAbout(energy, result, thicknessOf(sampled_points), scale.measurement_sigma),
      result.summary);
  return result;
}

} // namespace bayesian_icp
