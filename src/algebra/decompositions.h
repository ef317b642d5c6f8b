/** Decompositions of 6x6 matrices, and the eigenvectors of symmetric ones of any size.
 * They are compiled once, in decompositions.cpp: a compiler that meets one of them
 * elsewhere takes seconds for it. Those of an expression are other templates, so pass a
 * matrix: SelfAdjointEigenSolver<Matrix6d>(Matrix6d(A * B)). */
#pragma once

#include <bayesian_icp/pose.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#ifndef BAYESIAN_ICP_EXTERN
#define BAYESIAN_ICP_EXTERN extern
#endif

namespace Eigen {

using PoseVector = bayesian_icp::Vector6d;
using PoseSquare = bayesian_icp::Matrix6d;

BAYESIAN_ICP_EXTERN template SelfAdjointEigenSolver<PoseSquare>&
SelfAdjointEigenSolver<PoseSquare>::compute(const EigenBase<PoseSquare>&, int);
BAYESIAN_ICP_EXTERN template SelfAdjointEigenSolver<MatrixXd>&
SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);

BAYESIAN_ICP_EXTERN template LDLT<PoseSquare>&
LDLT<PoseSquare>::compute(const EigenBase<PoseSquare>&);
BAYESIAN_ICP_EXTERN template void
LDLT<PoseSquare>::_solve_impl_transposed<true>(const PoseVector&, PoseVector&) const;
BAYESIAN_ICP_EXTERN template void
LDLT<PoseSquare>::_solve_impl_transposed<true>(const PoseSquare&, PoseSquare&) const;

BAYESIAN_ICP_EXTERN template LLT<PoseSquare>&
LLT<PoseSquare>::compute(const EigenBase<PoseSquare>&);
BAYESIAN_ICP_EXTERN template void
LLT<PoseSquare>::_solve_impl_transposed<true>(const PoseVector&, PoseVector&) const;
BAYESIAN_ICP_EXTERN template void
LLT<PoseSquare>::_solve_impl_transposed<true>(const PoseSquare&, PoseSquare&) const;

BAYESIAN_ICP_EXTERN template class PartialPivLU<PoseSquare>;

} // namespace Eigen

namespace bayesian_icp {

/** \brief The nearest symmetric matrix. */
inline Matrix6d
symmetrized(const Matrix6d& m)
{
  return 0.5 * (m + m.transpose());
}

} // namespace bayesian_icp
