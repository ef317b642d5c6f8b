#include "graph/pose_graph.h"

#include "io/numbers.h"

#include <Eigen/Eigenvalues>

namespace bayesian_icp::app {

std::string
unmeasuredText(std::size_t num_unmeasured, std::size_t num_registrations)
{
  if (num_unmeasured == 0)
    return "";
  return io::textOf(num_unmeasured) + " of " + io::textOf(num_registrations) +
         " registrations leave a motion unmeasured: along it the result is the prior's "
         "assumption";
}

std::string
complaintAboutEdge(const Summary& summary)
{
  const std::string complaint = complaintAboutExport(PoseEstimate(summary), false);
  return complaint.empty() && summary.data.flags.mayBeInAnotherBasin()
             ? "the pose may be in another basin"
             : complaint;
}

Matrix6d
squareRootOf(const Matrix6d& covariance)
{
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance);
  const Matrix6d& axes = solver.eigenvectors();
  return axes * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         axes.transpose();
}

Matrix6d
adjointOf(const Eigen::Matrix4d& T)
{
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  Matrix6d adjoint;
  adjoint << R, crossMatrix(T.topRightCorner<3, 1>()) * R, Eigen::Matrix3d::Zero(), R;
  return adjoint;
}

Matrix6d
noiseToSource(const Eigen::Matrix4d& T)
{
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      T.topLeftCorner<3, 3>().transpose();
  return turn;
}

Vector6d
directionOf(const Eigen::Matrix4d& T)
{
  const Vector6d twist = logSE3(T);
  const double length = twist.norm();
  return length > 0.0 ? Vector6d(twist / length) : Vector6d(Vector6d::Unit(0));
}

CommonFactors
commonFactors(const Matrix6d& root, const Eigen::Matrix4d& T, double common)
{
  const Vector6d parts = std::sqrt(common) * directionOf(T);
  CommonFactors factors;
  for (int column = 0; column < 6; ++column)
    factors.middleCols<6>(6 * column) = parts[column] * root;
  return factors;
}

std::vector<std::pair<int, int>>
loopCandidates(const std::vector<GaussianPose>& poses, double radius)
{
  std::vector<std::pair<int, int>> loops;
  for (std::size_t later = 0; later < poses.size(); ++later) {
    bool was_away = false;
    double least = radius;
    std::size_t nearest = later;
    for (std::size_t k = later; k-- > 0;) {
      const double distance =
          (poses[k].mean.head<3>() - poses[later].mean.head<3>()).norm();
      was_away = was_away || distance > 2.0 * radius;
      if (!was_away || distance > least)
        continue;
      least = distance;
      nearest = k;
    }
    if (nearest != later)
      loops.emplace_back(static_cast<int>(nearest), static_cast<int>(later));
  }
  return loops;
}

} // namespace bayesian_icp::app
