#include "trajectories/trajectory_score.h"

#include "algebra/decompositions.h"

#include <Eigen/SVD>

#include <cmath>

namespace bayesian_icp::evaluate {

using Eigen::Index;
using Eigen::Isometry3d;

namespace {

double
angleOf(const Isometry3d& motion)
{
  return Eigen::AngleAxisd(motion.linear()).angle();
}

double
absoluteError(const std::vector<Isometry3d>& estimate,
              const std::vector<Isometry3d>& truth)
{
  const auto size = static_cast<Index>(truth.size());
  Eigen::Matrix3Xd from(3, size), to(3, size);
  for (Index k = 0; k < size; ++k) {
    from.col(k) = estimate[static_cast<std::size_t>(k)].translation();
    to.col(k) = truth[static_cast<std::size_t>(k)].translation();
  }
  const Isometry3d align(Eigen::umeyama(from, to, false));
  return std::sqrt((align * from - to).colwise().squaredNorm().mean());
}

double
normalizedSquaredError(const app::GaussianPose& estimate, const Isometry3d& truth)
{
  const Vector6d error =
      logSE3(Isometry3d(matrixOf(estimate.mean)).inverse().matrix() * truth.matrix());
  return error.dot(estimate.covariance.ldlt().solve(error)) / 6.0;
}

} // namespace

TrajectoryScore
scoreOf(const std::vector<app::GaussianPose>& estimate,
        const std::vector<Isometry3d>& truth)
{
  std::vector<Isometry3d> poses, true_poses;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    poses.emplace_back(matrixOf(estimate.at(k).mean));
    true_poses.push_back(truth[0].inverse() * truth[k]);
  }
  TrajectoryScore score;
  score.ate = absoluteError(poses, true_poses);
  const auto num_steps = static_cast<double>(truth.size() - 1);
  double translations = 0.0, rotations = 0.0;
  for (std::size_t k = 1; k < truth.size(); ++k) {
    const Isometry3d error = (true_poses[k - 1].inverse() * true_poses[k]).inverse() *
                             (poses[k - 1].inverse() * poses[k]);
    translations += error.translation().squaredNorm();
    rotations += std::pow(angleOf(error), 2);
    score.nees_of_last = normalizedSquaredError(estimate[k], true_poses[k]);
    score.nees += score.nees_of_last / num_steps;
  }
  score.rpe_translation = std::sqrt(translations / num_steps);
  score.rpe_rotation = std::sqrt(rotations / num_steps);
  const Isometry3d last_error = true_poses.back().inverse() * poses.back();
  score.drift_translation = last_error.translation().norm();
  score.drift_rotation = angleOf(last_error);
  return score;
}

} // namespace bayesian_icp::evaluate
