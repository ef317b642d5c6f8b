#include "exact/exact.h"

#include "exact/chain_pose_energy.h"
#include "exact/preconditioned_sampler.h"
#include "summary/plain_text.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

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

} // namespace

Eigen::Matrix3Xd
thinned(const Eigen::Matrix3Xd& points, std::size_t max_points)
{
  const auto chosen = evenlySpread(static_cast<std::size_t>(points.cols()), max_points);
  Eigen::Matrix3Xd kept(3, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    kept.col(static_cast<Eigen::Index>(i)) =
        points.col(static_cast<Eigen::Index>(chosen[i]));
  return kept;
}

ChainSet
sampleExact(const PoseEnergy& energy,
            const Vector6d& initial_pose,
            const ExactOptions& options,
            const ChainOptions& chain_options,
            const std::function<bool(const Vector6d&)>& has_diverged,
            const ProgressCallback& progress)
{
  PoseChainSettings settings;
  settings.start_centre = energy.toPhi(initial_pose);
  settings.start_spread = options.initial_spread.valueOr(
      energy.prior().variance().cwiseSqrt().cwiseMin(max_automatic_spread));
  settings.fixed_batch = evenlySpread(energy.numPoints(), fixed_batch_size);
  settings.has_diverged = has_diverged;

  ChainOptions chains = chain_options;
  if (!energy.target().isThreadSafe())
    chains.num_threads = 1;
  std::vector<std::unique_ptr<StochasticEnergy>> energies;
  for (int i = 0; i < chains.num_chains; ++i)
    energies.push_back(std::make_unique<ChainPoseEnergy>(energy, settings));
  return runPreconditionedChains(std::move(energies), options, chains, progress);
}

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

} // namespace bayesian_icp
