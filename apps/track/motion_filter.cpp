#include "track/motion_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::app {

namespace {

/** Where the errors of the parts are, and the noises of registrations. */
constexpr Eigen::Index of_target = 0, of_scan = 6, of_velocity = 12,
                       noise_of_target = 18, noise_of_scan = 24;
constexpr int num_noises = 6 + 6 + num_common;

/** Times that an update is linearised. */
constexpr int num_iterations = 5;

/** Largest standard deviation of what an interval adds to the motion [m, rad], so that
 * registrations after a pause of hours are not lost in its rounding. */
constexpr double max_deviation = 1e6;

/** J with exp(xi + d) = exp(xi) exp(J d) to first order in d: the sum of
 * (-ad(xi))^k / (k + 1)!, for large angles in closed form (Barfoot 2017, eq. 7.77). */
Matrix6d
rightJacobian(const Vector6d& xi)
{
  Matrix6d minus_ad = Matrix6d::Zero();
  minus_ad.topLeftCorner<3, 3>() = minus_ad.bottomRightCorner<3, 3>() =
      -crossMatrix(xi.tail<3>());
  minus_ad.topRightCorner<3, 3>() = -crossMatrix(xi.head<3>());
  const double a = xi.tail<3>().norm();
  Matrix6d term = Matrix6d::Identity(), sum = term;
  if (a < 1.0) {
    constexpr int max_terms = 100;
    for (int k = 1; k < max_terms && term.norm() > 1e-17 * sum.norm(); ++k) {
      term = term * minus_ad / double(k + 1);
      sum += term;
    }
    return sum;
  }
  const double sine = std::sin(a), cosine = std::cos(a), square = a * a;
  for (const double coefficient :
       {(4.0 - a * sine - 4.0 * cosine) / (2.0 * square),
        (4.0 * a - 5.0 * sine + a * cosine) / (2.0 * square * a),
        (2.0 - a * sine - 2.0 * cosine) / (2.0 * square * square),
        (2.0 * a - 3.0 * sine + a * cosine) / (2.0 * square * square * a)}) {
    term = term * minus_ad;
    sum += coefficient * term;
  }
  return sum;
}

} // namespace

MotionFilter::MotionFilter(const MotionModel& model)
: model_(model)
, in_plane_(projectionToPlane(model.plane_normal))
{
  velocity_ = in_plane_ * model.velocity;
  model_.velocity_covariance = in_plane_ * model.velocity_covariance * in_plane_;
  covariance_.block<6, 6>(of_velocity, of_velocity) = model_.velocity_covariance;
  covariance_.bottomRightCorner<num_noises, num_noises>().setIdentity();
}

void
MotionFilter::doubtVelocity()
{
  covariance_.block<6, 6>(of_velocity, of_velocity) += model_.velocity_covariance;
}

/** F P F^T; \p multiply makes F X of a matrix X. */
template <typename Multiply>
void
MotionFilter::propagate(const Multiply& multiply)
{
  for (int side = 0; side < 2; ++side) {
    multiply(covariance_);
    covariance_.transposeInPlace();
  }
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

void
MotionFilter::predict(double seconds)
{
  if (last_seconds_ > 0.0) {
    const double between_middles = 0.5 * (last_seconds_ + seconds);
    const double largest = max_deviation / seconds;
    Vector6d change;
    change << Eigen::Vector3d::Constant(
        std::min(model_.acceleration * between_middles, largest)),
        Eigen::Vector3d::Constant(
            std::min(model_.angular_acceleration * between_middles, largest));
    covariance_.block<6, 6>(of_velocity, of_velocity) +=
        in_plane_ * change.cwiseAbs2().asDiagonal() * in_plane_;
  }
  last_seconds_ = seconds;
  const Vector6d motion = velocity_ * seconds;
  const Eigen::Matrix4d step = expSE3(motion);
  scan_in_target_ = scan_in_target_ * step;
  const Matrix6d of_errors = adjointOf(step.inverse());
  const Matrix6d of_velocities = seconds * rightJacobian(motion);
  propagate([&](State& rows) {
    rows.middleRows<6>(of_scan) = of_errors * rows.middleRows<6>(of_scan) +
                                  of_velocities * rows.middleRows<6>(of_velocity);
    rows.middleRows<6>(noise_of_scan).setZero(); // it is another scan
  });
  covariance_.block<6, 6>(noise_of_scan, noise_of_scan).setIdentity();
  scan_noise_.setZero();
}

double
MotionFilter::update(const GaussianPose& measured, const SharedNoise& shared)
{
  const Eigen::Matrix4d to_measured =
      matrixOf(measured.mean).inverse() * scan_in_target_;
  const Matrix6d own = shared.own() * measured.covariance;
  const Matrix6d root = squareRootOf(measured.covariance);
  Eigen::Matrix<double, 6, num_errors> H = Eigen::Matrix<double, 6, num_errors>::Zero();
  H.middleCols<6>(noise_of_scan) = -std::sqrt(shared.scan) * root;
  H.middleCols<6>(noise_of_target) =
      std::sqrt(shared.scan) * root * noiseToSource(matrixOf(measured.mean));
  H.rightCols<num_common>() =
      -commonFactors(root, matrixOf(measured.mean), shared.common);
  const Vector6d of_noise = H.middleCols<6>(noise_of_target) * target_noise_ +
                            H.middleCols<6>(noise_of_scan) * scan_noise_;
  Eigen::Matrix<double, num_errors, 6> gain;
  Errors correction = Errors::Zero();
  double squared_innovation = 0.0;
  for (int iteration = 0; iteration < num_iterations; ++iteration) {
    const Vector6d xi = correction.segment<6>(of_scan);
    const Vector6d difference = logSE3(to_measured * expSE3(xi));
    const Matrix6d of_xi = rightJacobian(difference).inverse() * rightJacobian(xi);
    H.middleCols<6>(of_scan) = of_xi;
    const auto with_errors = (H * covariance_).eval();
    const Eigen::LDLT<Matrix6d> S(with_errors * H.transpose() + own);
    if (iteration == 0)
      squared_innovation = (difference + of_noise).dot(S.solve(difference + of_noise));
    gain = S.solve(with_errors).transpose();
    gain.bottomRows<num_common>().setZero();
    correction = gain * (of_xi * xi - difference - of_noise);
  }
  target_ = target_ * expSE3(correction.segment<6>(of_target));
  scan_in_target_ = scan_in_target_ * expSE3(correction.segment<6>(of_scan));
  velocity_ += correction.segment<6>(of_velocity);
  target_noise_ += correction.segment<6>(noise_of_target);
  scan_noise_ += correction.segment<6>(noise_of_scan);
  const Matrix6d of_new_target = rightJacobian(correction.segment<6>(of_target));
  const Matrix6d of_new_scan = rightJacobian(correction.segment<6>(of_scan));
  const auto aboutNew = [&](auto& rows) {
    auto target_rows = rows.template middleRows<6>(of_target);
    auto scan_rows = rows.template middleRows<6>(of_scan);
    target_rows = of_new_target * target_rows;
    scan_rows = of_new_scan * scan_rows;
  };
  // Joseph's form stays positive semi-definite. Errors are then about the new poses.
  propagate([&](State& rows) {
    rows -= gain * (H * rows);
    aboutNew(rows);
  });
  Eigen::Matrix<double, num_errors, 6> taken = gain;
  aboutNew(taken);
  const State noise = taken * own * taken.transpose();
  covariance_ += 0.5 * (noise + noise.transpose());
  return squared_innovation;
}

void
MotionFilter::makeScanTheTarget()
{
  const Matrix6d of_errors = adjointOf(scan_in_target_.inverse());
  propagate([&](State& rows) {
    rows.middleRows<6>(of_target) =
        of_errors * rows.middleRows<6>(of_target) + rows.middleRows<6>(of_scan);
    rows.middleRows<6>(of_scan).setZero();
    rows.middleRows<6>(noise_of_target) = rows.middleRows<6>(noise_of_scan);
  });
  target_ = target_ * scan_in_target_;
  scan_in_target_.setIdentity();
  target_noise_ = scan_noise_;
}

GaussianPose
MotionFilter::poseInTarget() const
{
  return {poseOf(scan_in_target_),
          keptInPlane(covariance_.block<6, 6>(of_scan, of_scan))};
}

GaussianPose
MotionFilter::pose() const
{
  MotionFilter moved = *this;
  moved.makeScanTheTarget();
  return {poseOf(moved.target_),
          keptInPlane(moved.covariance_.block<6, 6>(of_target, of_target))};
}

} // namespace bayesian_icp::app
