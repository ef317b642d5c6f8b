#include "graph/pose_graph.h"

#include <Eigen/Eigenvalues>

namespace bayesian_icp::app {

Matrix6d
squareRootOf(const Matrix6d& covariance)
{
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance);
  const Matrix6d& axes = solver.eigenvectors();
  return axes * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         axes.transpose();
}

} // namespace bayesian_icp::app
