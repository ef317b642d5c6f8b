#include "exact/pose_energy.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <numeric>

namespace bayesian_icp {

namespace {

/** Energy of a point without a match [m^2]: rho(d_max), or 0 without a gate. In the
 * latter case only a user's rejectors leave points unmatched. */
double
unmatchedEnergy(const ResidualOptions& options)
{
  if (!std::isfinite(options.max_distance))
    return 0.0;
  return robustEnergy(options, options.max_distance * options.max_distance);
}

/** Rows: the axes about which roll, pitch and yaw turn the moved points. */
Eigen::Matrix3d
rotationAxes(const Vector6d& pose)
{
  const double sp = std::sin(pose[4]), cp = std::cos(pose[4]);
  const double sy = std::sin(pose[5]), cy = std::cos(pose[5]);
  Eigen::Matrix3d axes;
  axes << cy * cp, sy * cp, -sp, // roll
      -sy, cy, 0.0,              // pitch
      0.0, 0.0, 1.0;             // yaw
  return axes;
}

Matrix6d
congruence(const Matrix6d& map, const Matrix6d& inner)
{
  return map * inner * map.transpose();
}

/** Force f at the lever arm a: translation and rotation vector. */
Vector6d
wrench(const Eigen::Vector3f& arm, const Eigen::Vector3f& force)
{
  Vector6d w;
  w << force.cast<double>(), arm.cross(force).cast<double>();
  return w;
}

/** The residual of one match, and how it changes. */
struct MatchResidual {
  /** r^2 [m^2]. */
  double squared;
  /** Gradient of r^2 / 2 with respect to the moved point, and where this force acts on
   * the rotation. */
  Eigen::Vector3f force;
  Eigen::Vector3f arm;
  /** M of a residual d^T M d that is neither of points nor of planes. */
  Eigen::Matrix3d information;
};

/** d is the distance along the normal, or all of it. */
MatchResidual
simpleResidual(const Eigen::Vector3f& arm, const Eigen::Vector3f& d)
{
  return {static_cast<double>(d.squaredNorm()), d, arm, Eigen::Matrix3d::Zero()};
}

/** d^T M d, M = (target + source)^-1. A rotation by w turns the source's covariance S,
 * too: with y = M d, half of the change of d^T M d is w . (y x S y), as if y acted at
 * the arm less S y. \param[in] source S, already in the target frame */
MatchResidual
distributionResidual(const Eigen::Vector3f& arm,
                     const Eigen::Vector3f& d,
                     const Eigen::Matrix3d& target,
                     const Eigen::Matrix3d& source)
{
  const Eigen::Matrix3d information = (target + source).inverse();
  const Eigen::Vector3d y = information * d.cast<double>();
  return {d.cast<double>().dot(y),
          y.cast<float>(),
          arm - (source * y).cast<float>(),
          information};
}

/** Energy of one match, and its gradient in rotation vectors. */
void
addResidual(const ResidualOptions& options,
            const MatchResidual& residual,
            BatchTerms::Extras extras,
            BatchTerms& terms)
{
  terms.energy += robustEnergy(options, residual.squared);
  if (extras == BatchTerms::Nothing)
    return;
  const Vector6d gradient =
      robustWeight(options, residual.squared) * wrench(residual.arm, residual.force);
  terms.gradient += gradient;
  if (extras == BatchTerms::SecondMoment)
    terms.second_moment.noalias() += gradient * gradient.transpose();
}

/** Gauss-Newton matrices of one match without its robust weight.
 * \param[in] normal zero if \p information says how distances count */
void
addCurvature(const Eigen::Vector3f& arm,
             const Eigen::Vector3f& normal,
             const Eigen::Matrix3d& information,
             BatchTerms& terms)
{
  Eigen::Matrix<double, 6, 3> rows;
  for (int k = 0; k < 3; ++k) {
    rows.col(k) = wrench(arm, Eigen::Vector3f::Unit(k));
    terms.point_curvature.noalias() += rows.col(k) * rows.col(k).transpose();
  }
  const Vector6d row = wrench(arm, normal);
  terms.plane_curvature.noalias() += row * row.transpose();
  if (normal.isZero(0.0f))
    terms.plane_curvature.noalias() += rows * information * rows.transpose();
}

} // namespace

double
robustEnergy(const ResidualOptions& options, double squared_residual)
{
  const double k = options.kernel_width;
  const bool is_within = squared_residual <= k * k;
  if (options.kernel == RobustKernel::Huber && !is_within)
    return k * (std::sqrt(squared_residual) - 0.5 * k);
  if (options.kernel != RobustKernel::Tukey)
    return 0.5 * squared_residual;
  const double rest = is_within ? 1.0 - squared_residual / (k * k) : 0.0;
  return k * k / 6.0 * (1.0 - rest * rest * rest);
}

double
robustWeight(const ResidualOptions& options, double squared_residual)
{
  const double k = options.kernel_width;
  const bool is_within = squared_residual <= k * k;
  if (options.kernel == RobustKernel::Huber && !is_within)
    return k / std::sqrt(squared_residual);
  if (options.kernel != RobustKernel::Tukey)
    return 1.0;
  const double rest = is_within ? 1.0 - squared_residual / (k * k) : 0.0;
  return rest * rest;
}

PoseEnergy::PoseEnergy(const Eigen::Matrix3Xd& source_points,
                       const Target& target,
                       const Prior& prior,
                       double weight,
                       const ResidualOptions& residual)
: target_(target)
, prior_(prior)
, weight_(weight)
, residual_(residual)
, centroid_(source_points.rowwise().mean())
, arms_((source_points.colwise() - centroid_).cast<float>())
, normals_(patchNormals(arms_))
{
  if (residual.residual == Residual::DistributionToDistribution)
    covariances_ = patchCovariances(arms_, residual.regularization);
}

double
PoseEnergy::energy(const Vector6d& theta) const
{
  EnergyWorkspace workspace = makeWorkspace();
  return energy(theta, workspace);
}

double
PoseEnergy::energy(const Vector6d& theta, EnergyWorkspace& workspace) const
{
  const auto terms =
      batchTerms(toPhi(theta), allPoints(), BatchTerms::Nothing, residual_, workspace);
  return weight_ * terms.energy + prior_.energy(theta);
}

Vector6d
PoseEnergy::toTheta(const Vector6d& phi) const
{
  Vector6d theta = phi;
  theta.head<3>() += centroid_ - rotationOf(phi) * centroid_;
  return theta;
}

Vector6d
PoseEnergy::toPhi(const Vector6d& theta) const
{
  Vector6d phi = theta;
  phi.head<3>() += rotationOf(theta) * centroid_ - centroid_;
  return phi;
}

void
PoseEnergy::moveBatch(const Vector6d& phi,
                      const std::vector<std::size_t>& indices,
                      EnergyWorkspace& workspace) const
{
  const Eigen::Matrix3f R = rotationOf(phi).cast<float>();
  const Eigen::Vector3f centre = (centroid_ + phi.head<3>()).cast<float>();
  const auto size = static_cast<Eigen::Index>(indices.size());
  workspace.arms.resize(3, size);
  workspace.moved.resize(3, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto index = indices[static_cast<std::size_t>(i)];
    workspace.arms.col(i).noalias() = R * arms_.col(static_cast<Eigen::Index>(index));
    workspace.moved.col(i) = workspace.arms.col(i) + centre;
  }
}

BatchTerms
PoseEnergy::batchTerms(const Vector6d& phi,
                       const std::vector<std::size_t>& indices,
                       BatchTerms::Extras extras,
                       const ResidualOptions& options,
                       EnergyWorkspace& workspace) const
{
  moveBatch(phi, indices, workspace);
  target_.match(
      toTheta(phi), indices, workspace.moved, workspace.neighbors, workspace.matches);
  const Eigen::Matrix3d R = rotationOf(phi);
  const Eigen::Matrix3f R_float = R.cast<float>();
  const bool is_plane = options.residual == Residual::PointToPlane;
  const bool is_distribution = options.residual == Residual::DistributionToDistribution;
  const double size = static_cast<double>(indices.size());

  BatchTerms terms;
  terms.energy =
      (size - static_cast<double>(workspace.matches.size())) * unmatchedEnergy(options);
  for (const auto& match : workspace.matches) {
    const auto column = static_cast<Eigen::Index>(match.column);
    const Eigen::Vector3f arm = workspace.arms.col(column);
    const Eigen::Vector3f d = workspace.moved.col(column) - match.point;
    terms.squared_distance += static_cast<double>(d.squaredNorm());
    const auto source = indices[match.column];
    const MatchResidual residual =
        is_distribution
            ? distributionResidual(
                  arm, d, *match.covariance, R * covariances_[source] * R.transpose())
            : simpleResidual(arm, is_plane ? match.normal.dot(d) * match.normal : d);
    addResidual(options, residual, extras, terms);
    if (extras != BatchTerms::Curvature)
      continue;
    Eigen::Vector3f normal = match.normal;
    if (options.residual == Residual::PointToPoint)
      normal = R_float * normals_.col(static_cast<Eigen::Index>(source));
    addCurvature(arm, normal, residual.information, terms);
  }

  // Derivatives by a rotation vector to derivatives by roll, pitch, yaw.
  Matrix6d map = Matrix6d::Identity();
  map.bottomRightCorner<3, 3>() = rotationAxes(phi);
  terms.energy /= size;
  terms.squared_distance /=
      std::max(1.0, static_cast<double>(workspace.matches.size()));
  terms.gradient = map * terms.gradient / size;
  if (extras == BatchTerms::SecondMoment)
    terms.second_moment = congruence(map, terms.second_moment / size);
  if (extras == BatchTerms::Curvature) {
    terms.point_curvature = congruence(map, terms.point_curvature / size);
    terms.plane_curvature = congruence(map, terms.plane_curvature / size);
  }
  return terms;
}

double
PoseEnergy::priorEnergy(const Vector6d& phi) const
{
  return prior_.energy(toTheta(phi));
}

Vector6d
PoseEnergy::priorGradient(const Vector6d& phi) const
{
  Vector6d gradient = prior_.energyGradient(toTheta(phi));
  const Eigen::Vector3d Rc = rotationOf(phi) * centroid_;
  gradient.tail<3>() -= rotationAxes(phi) * Rc.cross(gradient.head<3>());
  return gradient;
}

Matrix6d
PoseEnergy::priorPrecision() const
{
  // The prior's deviation has the translation of its reference point, R (ref - c) +
  // c + t' up to a constant.
  const Vector6d& mean = prior_.mean();
  const Eigen::Vector3d arm = rotationOf(mean) * (prior_.referencePoint() - centroid_);
  const Eigen::Matrix3d axes = rotationAxes(mean);
  Matrix6d jacobian = Matrix6d::Identity();
  for (int k = 0; k < 3; ++k)
    jacobian.block<3, 1>(0, 3 + k) = axes.row(k).transpose().cross(arm);
  return jacobian.transpose() * prior_.variance().cwiseInverse().asDiagonal() *
         jacobian;
}

std::vector<std::size_t>
PoseEnergy::allPoints() const
{
  std::vector<std::size_t> all(numPoints());
  std::iota(all.begin(), all.end(), std::size_t(0));
  return all;
}

EnergyWorkspace
PoseEnergy::makeWorkspace() const
{
  EnergyWorkspace workspace;
  workspace.neighbors = NeighborCache(numPoints());
  return workspace;
}

} // namespace bayesian_icp
