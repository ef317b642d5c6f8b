/** \file
 * \brief Graphs whose errors are drawn from their covariances.
 */
#pragma once

#include "graph/pose_graph.h"
#include "support/test_support.h"

#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bayesian_icp::test {

using Poses = std::vector<Eigen::Matrix4d>;

/** \brief Correlated, of about 1 cm and 2 mrad. */
inline Matrix6d
someCovariance(Random& random)
{
  Matrix6d sum = Matrix6d::Zero();
  for (int k = 0; k < 12; ++k) {
    Vector6d direction = random.normal6();
    direction.head<3>() *= 0.003;
    direction.tail<3>() *= 0.0006;
    sum += direction * direction.transpose();
  }
  return sum;
}

/** \brief About a metre apart, and the first one is the frame. */
inline Poses
somePoses(std::size_t count, Random& random)
{
  Poses poses(1, Eigen::Matrix4d::Identity());
  while (poses.size() < count)
    poses.push_back(matrixOf(randomPose(random, 0.9)));
  return poses;
}

/** \brief On a bent way, each a step of 1 m from the one before, the same each time. */
inline Poses
steadyPoses(std::size_t count)
{
  const Vector6d step(1.0, 0.0, 0.05, 0.0, 0.02, 0.1);
  Poses poses(1, Eigen::Matrix4d::Identity());
  while (poses.size() < count)
    poses.push_back(poses.back() * expSE3(step));
  return poses;
}

/** \brief Between two of \p poses, independent of all others. */
inline app::GraphEdge
drawnEdge(const Poses& poses, int target, int source, Random& random)
{
  const Matrix6d covariance = someCovariance(random);
  const Vector6d error = covariance.llt().matrixL() * random.normal6();
  return {target,
          source,
          poses[std::size_t(target)].inverse() * poses[std::size_t(source)] *
              expSE3(-error),
          covariance,
          app::independent_noise};
}

/** \brief Along the x axis [m], independent of all others.
 * \param[in] variance of each axis [m^2, rad^2] */
inline app::GraphEdge
edgeAlongX(int target, int source, double metres, double variance)
{
  app::GraphEdge edge;
  edge.target = target;
  edge.source = source;
  edge.T_target_source(0, 3) = metres;
  edge.covariance = variance * Matrix6d::Identity();
  edge.shared = app::independent_noise;
  return edge;
}

/** \brief (truth - estimate)^T S^-1 (truth - estimate), S the covariance. */
inline double
squaredErrorOf(const app::GaussianPose& estimate, const Eigen::Matrix4d& truth)
{
  return squaredError(logSE3(matrixOf(estimate.mean).inverse() * truth),
                      estimate.covariance);
}

/** \brief Both halves of \p noise, each by the inverse of T's rotation. */
inline Vector6d
turnedBack(const Eigen::Matrix4d& T, const Vector6d& noise)
{
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  return (Vector6d() << R.transpose() * noise.head<3>(),
          R.transpose() * noise.tail<3>())
      .finished();
}

/** \brief Unit vector of the motion [m, rad]. */
inline Vector6d
alongMotion(const Eigen::Matrix4d& T)
{
  return logSE3(T).normalized();
}

/** \brief From each pose to up to \p span before it. */
inline std::vector<app::GraphEdge>
drawnSpan(const Poses& poses, int span, const app::SharedNoise& shared, Random& random)
{
  const Matrix6d common = randomSquare(random);
  std::vector<Vector6d> noises; // of scans
  for (std::size_t k = 0; k < poses.size(); ++k)
    noises.push_back(random.normal6());
  std::vector<app::GraphEdge> edges;
  for (int source = 1; source < static_cast<int>(poses.size()); ++source)
    for (int target = source - 1; target >= std::max(0, source - span); --target) {
      app::GraphEdge edge = drawnEdge(poses, target, source, random);
      const Eigen::Matrix4d T =
          poses[std::size_t(target)].inverse() * poses[std::size_t(source)];
      const Vector6d z =
          std::sqrt(shared.scan) * (noises[std::size_t(source)] -
                                    turnedBack(T, noises[std::size_t(target)])) +
          std::sqrt(shared.common) * common * alongMotion(T) +
          std::sqrt(shared.own()) * random.normal6();
      const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(edge.covariance);
      edge.T_target_source = T * expSE3(Vector6d(-solver.operatorSqrt() * z));
      edge.shared = shared;
      edges.push_back(edge);
    }
  return edges;
}

} // namespace bayesian_icp::test
