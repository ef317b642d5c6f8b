// A Kalman filter of poses whose measurements are registrations, for the two examples
// kalman_fusion.cpp and kalman_sequence.cpp. docs/pose_graph_and_filter.md explains it.
#pragma once

#include <bayesian_icp/measurement.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

#include <Eigen/LU>

#include <string>

namespace kalman {

using namespace bayesian_icp;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

// [kalman]
/** A pose and its covariance, T_true = T exp(xi), xi = (v, w) ~ N(0, P) in the source
 * frame: CovarianceConvention::RightSE3. */
struct State {
  Eigen::Matrix4d T;
  Matrix6d P;
};

/** The robot moves by \p motion.T, which is known to motion.P. */
inline State
predict(const State& state, const State& motion)
{
  const Eigen::Matrix4d back = motion.T.inverse();
  const Eigen::Matrix3d R = back.topLeftCorner<3, 3>();
  Matrix6d adjoint = Matrix6d::Zero(); // exp(xi) motion = motion exp(adjoint xi)
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = R;
  adjoint.topRightCorner<3, 3>() = crossMatrix(back.topRightCorner<3, 1>()) * R;
  return {state.T * motion.T, adjoint * state.P * adjoint.transpose() + motion.P};
}

/** A registration measures the pose itself. It must not contain what the state already
 * knows: see withoutPrior(). The two are fused at the measurement, because it is far
 * from the state only along motions that the clouds hardly see, such as the turn of a
 * can about its axis, and there exp() follows that motion. */
inline State
update(const State& state, const State& measured)
{
  const Vector6d xi = logSE3(measured.T.inverse() * state.T);
  const Matrix6d gain = measured.P * (state.P + measured.P).inverse();
  const Matrix6d rest = Matrix6d::Identity() - gain;
  return {measured.T * expSE3(gain * xi),
          rest * measured.P * rest.transpose() + gain * state.P * gain.transpose()};
}

/** The normalised innovation squared. If both covariances are right, its mean is the
 * number of directions that are measured. */
inline double
innovation(const State& state, const State& measured)
{
  const Vector6d xi = logSE3(state.T.inverse() * measured.T);
  return xi.dot((state.P + measured.P).inverse() * xi);
}
// [/kalman]

/** The prior of a registration near \p predicted: its variances are of the parameters
 * (x, y, z, roll, pitch, yaw) in the target's axes, and five times as wide. */
inline Prior
priorAbout(const State& predicted)
{
  const Vector6d mean = poseOf(predicted.T);
  const PoseEstimate estimate =
      estimateOf(mean, predicted.P, CovarianceConvention::RightSE3);
  const Matrix6d& P = estimate.covariance(CovarianceConvention::Parameters);
  return Prior(mean, 25.0 * P.diagonal());
}

/** What the clouds alone say about a pose. */
struct Registration {
  bool is_usable = false;
  std::string message; ///< why it is not usable, or what to know about it
  State measured;
  int num_unmeasured = 6; ///< directions that the clouds do not see
};

/** Register \p source to \p target near \p predicted. The prior is taken out again,
 * because the filter knows the prediction already. */
inline Registration
registerNear(const State& predicted,
             const Cloud::ConstPtr& source,
             const Cloud::ConstPtr& target)
{
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  const Prior prior = priorAbout(predicted);
  icp.setPreset(Preset::Calibrated);
  icp.setPrior(prior.mean(), prior.variance());
  icp.setPriorFrame(PriorFrame::Origin); // that of priorAbout()
  icp.setInputSource(source);
  icp.setInputTarget(target);
  Cloud aligned;
  icp.align(aligned, predicted.T.cast<float>());

  const Summary& summary = icp.getSummary();
  Registration result;
  result.message = summary.message;
  if (summary.status != Status::Ok && summary.status != Status::Doubtful)
    return result;
  const PoseMeasurement measurement = withoutPrior(PoseEstimate(summary), prior);
  const PoseEstimate& estimate = measurement.estimate;
  result.measured = {matrixOf(estimate.mean),
                     estimate.covariance(CovarianceConvention::RightSE3)};
  result.num_unmeasured = measurement.num_unmeasured;
  result.is_usable = result.num_unmeasured < 6;
  return result;
}

} // namespace kalman
