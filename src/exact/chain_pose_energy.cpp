#include "exact/chain_pose_energy.h"

#include "algebra/decompositions.h"

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

double
gainOf(int step)
{
  return step < num_full_steps ? 1.0 : 1.0 / (1.0 + 0.5 * (step - num_full_steps));
}

Vector6d
limitStep(const Vector6d& step)
{
  const double length = step.head<3>().norm() / max_step_length;
  const double angle = step.tail<3>().norm() / max_step_angle;
  return step / std::max({1.0, length, angle});
}

} // namespace

ChainPoseEnergy::ChainPoseEnergy(const PoseEnergy& pose_energy,
                                 const PoseChainSettings& settings)
: pose_energy_(pose_energy)
, settings_(settings)
, prior_precision_(pose_energy.priorPrecision())
, all_points_(pose_energy.allPoints())
, workspace_(pose_energy.makeWorkspace())
, batches_(all_points_)
{}

std::size_t
ChainPoseEnergy::numTerms() const
{
  return pose_energy_.numPoints();
}

BatchTerms
ChainPoseEnergy::terms(const Vector6d& phi,
                       const std::vector<std::size_t>& batch,
                       BatchTerms::Extras extras)
{
  return pose_energy_.batchTerms(
      phi, batch, extras, pose_energy_.residual(), workspace_);
}

SplitGradient
ChainPoseEnergy::gradient(const Vector6d& phi, std::size_t batch_size, Random& random)
{
  const auto batch =
      terms(phi, batches_.subset(batch_size, random), BatchTerms::Gradient);
  return {pose_energy_.weight() * batch.gradient, pose_energy_.priorGradient(phi)};
}

Matrix6d
ChainPoseEnergy::termCovariance(const Vector6d& phi, Random& random)
{
  const auto& indices = batches_.subset(probe_size, random);
  const auto batch = terms(phi, indices, BatchTerms::SecondMoment);
  const double m = static_cast<double>(indices.size());
  const double unbiased = m > 1.0 ? m / (m - 1.0) : 0.0;
  return pose_energy_.weight() * pose_energy_.weight() * unbiased *
         (batch.second_moment - batch.gradient * batch.gradient.transpose());
}

Matrix6d
ChainPoseEnergy::roughCurvature(const Vector6d& phi)
{
  const auto batch = terms(phi, settings_.fixed_batch, BatchTerms::Curvature);
  return pose_energy_.weight() *
         (batch.plane_curvature + fit_point_share * batch.point_curvature);
}

Matrix6d
ChainPoseEnergy::priorPrecision() const
{
  return prior_precision_;
}

double
ChainPoseEnergy::energyOf(const std::vector<std::size_t>& batch, const Vector6d& phi)
{
  return pose_energy_.weight() * terms(phi, batch, BatchTerms::Nothing).energy +
         pose_energy_.priorEnergy(phi);
}

double
ChainPoseEnergy::energy(const Vector6d& phi)
{
  return energyOf(settings_.fixed_batch, phi);
}

double
ChainPoseEnergy::fullEnergy(const Vector6d& phi)
{
  return energyOf(all_points_, phi);
}

Vector6d
ChainPoseEnergy::toPose(const Vector6d& phi) const
{
  return pose_energy_.toTheta(phi);
}

Vector6d
ChainPoseEnergy::drawStart(Random& random)
{
  return settings_.start_centre + settings_.start_spread.cwiseProduct(random.normal6());
}

Vector6d
ChainPoseEnergy::burnIn(const Vector6d& start, Random& random)
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
    phi -= gainOf(step) * limitStep(curvature.ldlt().solve(gradient));
  }
  return phi;
}

double
ChainPoseEnergy::initialTemperature(const Vector6d& phi, const Matrix6d& covariance)
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
ChainPoseEnergy::hasDiverged(const Vector6d& phi) const
{
  return !phi.allFinite() || settings_.has_diverged(toPose(phi));
}

} // namespace bayesian_icp
