// Fuses a registration with odometry: kalman_fusion source.pcd target.pcd ODOMETRY
// ODOMETRY is a file with the 4x4 matrix T_target_source that the wheels have measured,
// to 2 cm and 0.02 rad. docs/pose_graph_and_filter.md explains every step.
#include "kalman.h"

#include <pcl/io/pcd_io.h>

#include <fstream>
#include <iostream>

namespace {

using namespace kalman;

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
  const Cloud::Ptr source(new Cloud), target(new Cloud);
  State start{Eigen::Matrix4d::Identity(), Matrix6d::Zero()}, odometry;
  if (argc != 4 || pcl::io::loadPCDFile(argv[1], *source) < 0 ||
      pcl::io::loadPCDFile(argv[2], *target) < 0 || !readMatrix(argv[3], odometry.T)) {
    std::cerr << "Usage: " << argv[0] << " source.pcd target.pcd ODOMETRY\n";
    return 2;
  }
  odometry.P = 0.02 * 0.02 * Matrix6d::Identity();
  const State predicted = predict(start, odometry);

  const Registration registration = registerNear(predicted, source, target);
  std::cout << registration.message << '\n';
  if (!registration.is_usable)
    return 1; // No update: the prediction stays.
  print("odometry", predicted);
  print("clouds, without the prior", registration.measured);
  std::cout << "  directions that they do not see: " << registration.num_unmeasured
            << '\n';
  print("fused", update(predicted, registration.measured));
  return 0;
}
