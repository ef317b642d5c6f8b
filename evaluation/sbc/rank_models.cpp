#include "sbc/rank_models.h"

#include "algebra/decompositions.h"
#include "calibrated/draws/product_coordinates.h"

#include <Eigen/QR>

#include <cmath>

namespace bayesian_icp::evaluate {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

constexpr double pi = 3.14159265358979323846;

/** FarPointsModel: points on each side of a cube, and the distance of neighbours [m].
 */
constexpr int num_on_side = 3;
constexpr double point_distance = 1.5;

/** LinearScoreModel. */
constexpr Index num_score_points = 400;
constexpr double reference_distance = 1.0;
constexpr double translation_sd = 0.03, angle_sd = 0.06, free_yaw_sd = 1.0;
/** Factor by which all points together are less certain than each of them suggests. */
constexpr double correlation = 4.0;
/** Standard deviation of the points' errors, residual noise = 1. */
constexpr double error_of_points = 0.5;

double
logUniform(double least, double most, Random& random)
{
  return least * std::pow(most / least, random.uniform());
}

/** Density proportional to exp(cos(x) / variance), by rejection from a Gaussian of
 * (pi / 2)^2 times the variance: 1 - cos x >= 2 (x / pi)^2. */
double
drawVonMises(double variance, Random& random)
{
  while (true) {
    const double x = 0.5 * pi * std::sqrt(variance) * random.normal();
    if (std::abs(x) <= pi &&
        random.uniform() <
            std::exp((std::cos(x) - 1.0 + 2.0 * x * x / (pi * pi)) / variance))
      return x;
  }
}

Prior
farPointsPrior(Random& random)
{
  Vector6d mean, sd;
  for (int k = 0; k < 6; ++k) {
    mean[k] = 2.0 * random.uniform() - 1.0;
    sd[k] = logUniform(0.002, 0.02, random);
  }
  return Prior(mean, sd.cwiseAbs2());
}

Eigen::Matrix3Xd
cubeLattice()
{
  Eigen::Matrix3Xd points(3, num_on_side * num_on_side * num_on_side);
  for (int i = 0; i < points.cols(); ++i)
    points.col(i) =
        point_distance * Eigen::Vector3i(i % num_on_side - 1,
                                         i / num_on_side % num_on_side - 1,
                                         i / (num_on_side * num_on_side) - 1)
                             .cast<double>();
  return points;
}

/** Its mean has no tilt: only then do small angles count alike as twists and as roll,
 * pitch and yaw. */
Prior
linearScorePrior(bool is_yaw_free, Random& random)
{
  Vector6d mean, sd;
  mean << random.normal(), random.normal(), random.normal(), 0.0, 0.0,
      pi * (2.0 * random.uniform() - 1.0);
  sd << Vector3d::Constant(translation_sd), Vector3d::Constant(angle_sd);
  if (is_yaw_free)
    sd[5] = free_yaw_sd;
  const Vector3d reference(
      reference_distance * random.normal(), reference_distance * random.normal(), 0.0);
  return Prior(mean, sd.cwiseAbs2(), reference);
}

/** A random rotation of the first \p size axes. */
Matrix6d
randomAxes(Index size, Random& random)
{
  MatrixXd normals(size, size);
  for (Index i = 0; i < normals.size(); ++i)
    normals.data()[i] = random.normal();
  Matrix6d axes = Matrix6d::Identity();
  axes.topLeftCorner(size, size) =
      MatrixXd(Eigen::HouseholderQR<MatrixXd>(normals).householderQ());
  return axes;
}

} // namespace

Vector6d
drawFrom(const Prior& prior, Random& random)
{
  const Vector6d sd = prior.variance().cwiseSqrt();
  Vector6d pose = prior.mean();
  for (int k = 3; k < 6; ++k)
    pose[k] += drawVonMises(prior.variance()[k], random);
  const Vector3d mean_reference = isometryOf(prior.mean()) * prior.referencePoint();
  const Vector3d deviation(random.normal(), random.normal(), random.normal());
  pose.head<3>() = mean_reference + sd.head<3>().cwiseProduct(deviation) -
                   rotationOf(pose) * prior.referencePoint();
  return pose;
}

FarPointsModel::FarPointsModel(Random& random)
: prior(farPointsPrior(random))
, truth(drawFrom(prior, random))
, target(cubeLattice())
, noise(logUniform(0.003, 0.03, random))
{
  source = isometryOf(truth).inverse() * target;
  for (Index i = 0; i < source.size(); ++i)
    source.data()[i] += noise * random.normal();
}

LinearScoreModel::LinearScoreModel(bool is_yaw_free, Random& random)
: prior(linearScorePrior(is_yaw_free, random))
, truth(drawFrom(prior, random))
{
  setInformation(is_yaw_free, random);
  drawScores(random);
  CalibratedEstimate& e = estimate;
  e.covariance = (e.information + e.prior.precision).inverse();
  e.mean =
      -e.covariance * (e.curvature * e.score_covariance.ldlt().solve(e.scores.total) +
                       e.prior.gradient);
}

void
LinearScoreModel::setInformation(bool is_yaw_free, Random& random)
{
  CalibratedEstimate& e = estimate;
  e.mode = isometryOf(prior.mean());
  e.centre = e.mode * prior.referencePoint();
  e.prior = twistPrior(prior, e.mode, e.centre);
  const Vector6d prior_sd = prior.variance().cwiseSqrt();
  e.directions = prior_sd.asDiagonal() * randomAxes(is_yaw_free ? 5 : 6, random);
  e.keep = Vector6d::Ones();
  Vector6d rates;
  for (int k = 0; k < 6; ++k)
    rates[k] = std::sqrt(correlation * logUniform(0.1, 1000.0, random) /
                         static_cast<double>(num_score_points));
  if (is_yaw_free)
    e.keep[5] = rates[5] = 0.0;
  e.transfer = e.keep.asDiagonal();
  const Matrix6d to_directions = e.directions.inverse();
  Matrix6Xd& jacobians = e.scores.jacobians;
  jacobians.resize(6, num_score_points);
  for (Index i = 0; i < num_score_points; ++i)
    jacobians.col(i) = to_directions.transpose() * rates.cwiseProduct(random.normal6());
  e.scores.information = jacobians * jacobians.transpose();
  e.curvature = e.scores.information;
  // A little more than the points tell, so that there is an inverse.
  e.score_covariance =
      correlation * e.curvature + 0.01 * to_directions.transpose() * to_directions;
  e.information = e.curvature * e.score_covariance.ldlt().solve(e.curvature);
}

void
LinearScoreModel::drawScores(Random& random)
{
  CalibratedEstimate& e = estimate;
  e.scores.total.setZero();
  const ProductCoordinates coordinates(e);
  const Vector6d at_truth =
      coordinates.scoredTwist(coordinates.heldPart(isometryOf(truth)));
  const Matrix6d factor = e.score_covariance.llt().matrixL();
  SurfaceScores& scores = e.scores;
  scores.total = factor * random.normal6() - e.curvature * at_truth;
  const Matrix6Xd& jacobians = scores.jacobians;
  scores.scores.resize(6, num_score_points);
  errors_.resize(num_score_points);
  for (Index i = 0; i < num_score_points; ++i)
    errors_[i] = error_of_points * random.normal();
  errors_ -=
      jacobians.transpose() *
      scores.information.completeOrthogonalDecomposition().solve(jacobians * errors_);
  // Of what every point tells only the sum matters.
  scores.scores.colwise() = Vector6d(scores.total / double(num_score_points));
  scores.residuals.setZero(num_score_points);
  scores.active.assign(num_score_points, 1);
  scores.has_patch.assign(num_score_points, 1);
  scores.num_active = static_cast<int>(num_score_points);
}

BatchScore
LinearScoreModel::score() const
{
  return [this](const CalibratedEstimate&,
                const Eigen::Isometry3d& T_target_source,
                const std::vector<std::size_t>& indices,
                PatchHints&,
                Vector6d& total) {
    const SurfaceScores& scores = estimate.scores;
    const Vector6d xi = twistBetween(estimate.mode, T_target_source, estimate.centre);
    total.setZero();
    for (const std::size_t index : indices) {
      const auto i = static_cast<Index>(index);
      const auto jacobian = scores.jacobians.col(i);
      total += scores.scores.col(i) + jacobian * (errors_[i] + jacobian.dot(xi));
    }
    return static_cast<int>(indices.size());
  };
}

} // namespace bayesian_icp::evaluate
