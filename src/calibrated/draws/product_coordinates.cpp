#include "calibrated/draws/product_coordinates.h"

#include "algebra/pseudo_inverse.h"

#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/** Ad(exp(xi))^T g: a gradient with respect to twists on the left of exp(xi), for
 * twists on its right. */
Vector6d
carriedToTheRight(const Vector6d& xi, const Vector6d& gradient)
{
  const Eigen::Matrix4d motion = expSE3(xi);
  const Matrix3d R = motion.topLeftCorner<3, 3>();
  const Vector3d t = motion.topRightCorner<3, 1>();
  Vector6d carried;
  carried.head<3>() = R.transpose() * gradient.head<3>();
  carried.tail<3>() =
      R.transpose() * (gradient.tail<3>() - t.cross(Vector3d(gradient.head<3>())));
  return carried;
}

/** ad(xi), the Lie bracket with xi. */
Matrix6d
bracketWith(const Vector6d& xi)
{
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = crossMatrix(xi.tail<3>());
  ad.topRightCorner<3, 3>() = crossMatrix(xi.head<3>());
  return ad;
}

/** J_l(xi)^T g: a gradient with respect to twists on the left of exp(xi), for changes
 * of xi itself. J_l = sum_n ad(xi)^n / (n + 1)!. */
Vector6d
carriedToTheExponent(const Vector6d& xi, const Vector6d& gradient)
{
  constexpr int max_terms = 40;
  const Matrix6d ad = bracketWith(xi);
  Vector6d sum = gradient, term = gradient;
  for (int n = 1; n < max_terms; ++n) {
    term = (ad.transpose() * term / (n + 1)).eval();
    sum += term;
    if (term.squaredNorm() <= 1e-28 * sum.squaredNorm())
      break;
  }
  return sum;
}

} // namespace

ProductCoordinates::ProductCoordinates(const CalibratedEstimate& estimate)
: mode_(estimate.mode)
, centre_(estimate.centre)
, transfer_(estimate.transfer)
, prior_only_(Matrix6d::Zero())
, held_(Matrix6d::Zero())
{
  for (int k = 0; k < 6; ++k)
    if (estimate.keep[k] <= 0.0)
      prior_only_.col(num_prior_only_++) = estimate.directions.col(k);
  int next = num_prior_only_;
  for (int k = 0; k < 6; ++k)
    if (estimate.keep[k] > 0.0)
      held_.col(next++) = estimate.directions.col(k);
  setUnwinding(estimate.prior.precision);
  setVolume();
  setLikelihood(estimate);
  const Matrix6d basis = prior_only_ + held_;
  const Vector6d gradient = basis.transpose() * estimate.prior.gradient;
  const Matrix6d precision =
      information_ + basis.transpose() * estimate.prior.precision * basis;
  gaussian_ = Gaussian(
      precision.llt().solve(Vector6d(information_ * best_fit_ - gradient)), precision);
}

void
ProductCoordinates::setUnwinding(const Matrix6d& prior_precision)
{
  if (num_prior_only_ == 0)
    return;
  const Eigen::MatrixXd V0 = prior_only_.leftCols(num_prior_only_);
  const Eigen::MatrixXd rotations = V0.bottomRows<3>();
  const Eigen::MatrixXd weighted =
      (V0.transpose() * prior_precision * V0).llt().solve(rotations.transpose());
  // A smaller part of the rotation is a tilt of the other directions.
  constexpr double least_part = 0.01;
  unwinding_.topRows(num_prior_only_) =
      weighted * pseudoInverse(Matrix3d(rotations * weighted), least_part);
}

/** log |det(W J_r(V0 a) V0)| to second order in a, with W the first rows of [V0 VK]^-1
 * and J_r = 1 - ad / 2 + ad^2 / 6. */
void
ProductCoordinates::setVolume()
{
  const Matrix6d W = (prior_only_ + held_).inverse();
  const auto W0 = W.topRows(num_prior_only_);
  const auto V0 = prior_only_.leftCols(num_prior_only_);
  for (int k = 0; k < num_prior_only_; ++k) {
    const Matrix6d ad_k = bracketWith(V0.col(k));
    volume_slope_[k] = -0.5 * (W0 * ad_k * V0).trace();
    for (int l = 0; l < num_prior_only_; ++l) {
      const Matrix6d ad_l = bracketWith(V0.col(l));
      volume_curvature_(k, l) = (W0 * (ad_k * ad_l + ad_l * ad_k) * V0).trace() / 6.0 -
                                (W0 * ad_k * V0 * W0 * ad_l * V0).trace() / 4.0;
    }
  }
}

Vector6d
ProductCoordinates::unwound(const Vector6d& z) const
{
  constexpr double turn = 2.0 * M_PI;
  const Vector3d rotation = (prior_only_ * z).tail<3>();
  const double angle = rotation.norm();
  const double num_turns = std::round(angle / turn);
  if (num_turns == 0.0)
    return z;
  return z - unwinding_ * (num_turns * turn / angle * rotation);
}

void
ProductCoordinates::setLikelihood(const CalibratedEstimate& estimate)
{
  const int num_held = 6 - num_prior_only_;
  if (num_held == 0)
    return;
  const Eigen::LDLT<Matrix6d> J(estimate.score_covariance);
  const Matrix6d HT = estimate.curvature * transfer_ * held_;
  score_weights_ = J.solve(HT).transpose();
  information_ = held_.transpose() * estimate.information * held_;
  best_fit_.tail(num_held) =
      -information_.bottomRightCorner(num_held, num_held)
           .ldlt()
           .solve((score_weights_ * estimate.scores.total).tail(num_held));
}

Isometry3d
ProductCoordinates::pose(const Vector6d& z) const
{
  return movedBy(prior_only_ * unwound(z), centre_, movedBy(held_ * z, centre_, mode_));
}

Vector6d
ProductCoordinates::heldPart(const Isometry3d& pose) const
{
  constexpr int num_scanned = 60, max_rounds = 20;
  const Matrix6d to_z = (prior_only_ + held_).inverse();
  const auto restOf = [&](const Vector6d& a) -> Vector6d {
    return to_z *
           twistBetween(mode_, movedBy(-prior_only_ * a, centre_, pose), centre_);
  };
  Vector6d a = Vector6d::Zero();
  if (num_prior_only_ == 1 && prior_only_.col(0).tail<3>().norm() > 0.0) {
    // A first time: far from the mode the rounds below may not converge.
    const double half_turn = M_PI / prior_only_.col(0).tail<3>().norm();
    double least = std::numeric_limits<double>::infinity(), best = 0.0;
    for (int i = -num_scanned; i <= num_scanned; ++i) {
      a[0] = half_turn * i / num_scanned;
      const Vector6d rest = restOf(a);
      const double energy = rest.dot((information_ * rest)) +
                            rest[0] * rest[0] * gaussian_.precision()(0, 0);
      if (energy < least) {
        least = energy;
        best = a[0];
      }
    }
    a[0] = best;
  }
  for (int round = 0; round < max_rounds && num_prior_only_ > 0; ++round) {
    const Vector6d rest = restOf(a);
    a.head(num_prior_only_) += rest.head(num_prior_only_);
    if (rest.head(num_prior_only_).norm() < 1e-10)
      break;
  }
  Vector6d rest = restOf(a);
  rest.head(num_prior_only_).setZero();
  return rest;
}

double
ProductCoordinates::logVolume() const
{
  return std::log(std::abs((prior_only_ + held_).determinant()));
}

Vector6d
ProductCoordinates::priorGradient(const Vector6d& z, const HeldPrior& prior) const
{
  const Vector6d gradient = twistPriorGradient(prior, pose(z), centre_);
  const Vector6d a = prior_only_ * unwound(z), b = held_ * z;
  return prior_only_.transpose() * carriedToTheExponent(a, gradient) +
         held_.transpose() * carriedToTheExponent(b, carriedToTheRight(a, gradient));
}

} // namespace bayesian_icp
