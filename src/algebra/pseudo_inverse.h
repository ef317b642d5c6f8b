#pragma once

#include "algebra/decompositions.h"

namespace bayesian_icp {

/** \brief Pseudo-inverse of a symmetric positive semidefinite matrix of fixed size.
 * Eigenvalues up to \p least_relative times the largest one count as 0. */
template <typename Matrix>
Matrix
pseudoInverse(const Matrix& symmetric, double least_relative)
{
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric);
  const auto& values = solver.eigenvalues();
  const double least = least_relative * values.maxCoeff();
  const auto inverses = (values.array() > least)
                            .select(values.cwiseMax(least).cwiseInverse(), 0.0)
                            .matrix()
                            .eval();
  const Matrix& axes = solver.eigenvectors();
  return axes * inverses.asDiagonal() * axes.transpose();
}

} // namespace bayesian_icp
