// Fuses a registration with odometry: kalman_fusion source.pcd target.pcd ODOMETRY
// ODOMETRY is a file with the 4x4 matrix T_target_source that the wheels have measured,
// to 2 cm and 0.02 rad. docs/pose_graph_and_filter.md explains every step.
#include <bayesian_icp/measurement.h>

#include <pcl/io/pcd_io.h>
#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

#include <Eigen/LU>

#include <fstream>
#include <iostream>

namespace {

using namespace bayesian_icp;

// [kalman]
/** A pose and its covariance, T_true = T exp(xi), xi = (v, w) ~ N(0, P) in the source
 * frame: CovarianceConvention::RightSE3. */
struct State {
  Eigen::Matrix4d T;
  Matrix6d P;
};

/** The robot moves by \p motion.T, which is known to motion.P. */
State
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
 * knows: see withoutPrior(). */
State
update(const State& state, const State& measured)
{
  const Vector6d xi = logSE3(state.T.inverse() * measured.T);
  const Matrix6d gain = state.P * (state.P + measured.P).inverse();
  const Matrix6d rest = Matrix6d::Identity() - gain;
  return {state.T * expSE3(gain * xi),
          rest * state.P * rest.transpose() + gain * measured.P * gain.transpose()};
}
// [/kalman]

void
print(const char* what, const State& state)
{
  std::cout << what << "\n  pose x y z [m] roll pitch yaw [rad]: "
            << poseOf(state.T).transpose()
            << "\n  standard deviations, source axes [m, rad]: "
            << state.P.diagonal().cwiseSqrt().transpose() << '\n';
}

bool
readMatrix(const char* file, Eigen::Matrix4d& matrix)
{
  std::ifstream stream(file);
  for (Eigen::Index i = 0; i < 16; ++i)
    if (!(stream >> matrix(i / 4, i % 4)))
      return false;
  return true;
}

} // namespace

int
main(int argc, char** argv)
{
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  const Cloud::Ptr source(new Cloud), target(new Cloud);
  State start{Eigen::Matrix4d::Identity(), Matrix6d::Zero()}, odometry;
  if (argc != 4 || pcl::io::loadPCDFile(argv[1], *source) < 0 ||
      pcl::io::loadPCDFile(argv[2], *target) < 0 || !readMatrix(argv[3], odometry.T)) {
    std::cerr << "Usage: " << argv[0] << " source.pcd target.pcd ODOMETRY\n";
    return 2;
  }
  odometry.P = 0.02 * 0.02 * Matrix6d::Identity();
  const State predicted = predict(start, odometry);

  // The odometry is where the search starts. The prior about it is wide on purpose: it
  // is taken out again.
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  PriorOptions prior;
  prior.mean = poseOf(predicted.T);
  prior.variance.setConstant(0.1 * 0.1);
  icp.setPreset(Preset::Calibrated);
  icp.setPrior(prior.mean, prior.variance);
  icp.setPriorFrame(PriorFrame::Origin); // that of the Prior below
  icp.setInputSource(source);
  icp.setInputTarget(target);
  Cloud aligned;
  icp.align(aligned, predicted.T.cast<float>());
  const Summary& summary = icp.getSummary();
  std::cout << summary.message << '\n';
  if (summary.status != Status::Ok && summary.status != Status::Doubtful)
    return 1; // No update: the prediction stays.

  const PoseMeasurement measurement =
      withoutPrior(PoseEstimate(summary), Prior(prior.mean, prior.variance));
  const State measured{matrixOf(measurement.estimate.mean),
                       measurement.estimate.covariance(CovarianceConvention::RightSE3)};
  print("odometry", predicted);
  print("clouds, without the prior", measured);
  std::cout << "  directions that they do not see: " << measurement.num_unmeasured
            << '\n';
  print("fused", update(predicted, measured));
  return 0;
}
