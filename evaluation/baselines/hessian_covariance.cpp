#include "baselines/hessian_covariance.h"

#include "algebra/decompositions.h"
#include "baselines/matched_pair.h"

#include <limits>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Vector3d;

GaussNewton
gaussNewton(const MatchedPoints& matches, const Vector3d& centre)
{
  GaussNewton sums;
  for (Index i = 0; i < matches.moved.cols(); ++i) {
    const MatchedPair pair(matches, i, centre);
    sums.hessian += pair.motion.transpose() * pair.projector * pair.motion;
    sums.gradient += pair.motion.transpose() * pair.force;
    sums.sum_of_squares += pair.force.squaredNorm();
  }
  sums.num_residuals = matches.moved.cols() * (matches.hasNormals() ? 1 : 3);
  return sums;
}

double
residualVariance(const GaussNewton& sums)
{
  if (sums.num_residuals == 0)
    return std::numeric_limits<double>::quiet_NaN();
  return sums.sum_of_squares / static_cast<double>(sums.num_residuals);
}

Matrix6d
generalizedIcpHessian(const Eigen::Matrix3Xd& moved,
                      const std::vector<Eigen::Matrix3d>& covariances,
                      const Vector3d& centre)
{
  Matrix6d hessian = Matrix6d::Zero();
  for (Index i = 0; i < moved.cols(); ++i) {
    const Matrix36d motion = motionOf(moved.col(i) - centre);
    hessian += motion.transpose() * covariances[static_cast<std::size_t>(i)].inverse() *
               motion;
  }
  return hessian;
}

Matrix6d
hessianCovariance(const Matrix6d& hessian, double sigma)
{
  return sigma * sigma * hessian.inverse();
}

} // namespace bayesian_icp
