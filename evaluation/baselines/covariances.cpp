#include "baselines/covariances.h"

#include "algebra/decompositions.h"
#include "algebra/pseudo_inverse.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

using Matrix36d = Eigen::Matrix<double, 3, 6>;
using Matrix63d = Eigen::Matrix<double, 6, 3>;

/** A = [I, -[arm]x]: how a point moves with the twist (v, w). */
Matrix36d
motionOf(const Vector3d& arm)
{
  Matrix36d motion;
  motion << Matrix3d::Identity(), -crossMatrix(arm);
  return motion;
}

/** One pair. With N = I, or n n^T if there is a normal, its energy is
 * 0.5 (p - q)^T N (p - q). */
struct MatchedPair {
  MatchedPair(const MatchedPoints& matches, Index i, const Vector3d& centre)
  : arm(matches.moved.col(i) - centre)
  , motion(motionOf(arm))
  , projector(Matrix3d::Identity())
  {
    if (matches.hasNormals())
      projector = matches.normals.col(i) * matches.normals.col(i).transpose();
    force = projector * (matches.moved.col(i) - matches.target.col(i));
  }

  /** p - centre. */
  Vector3d arm;
  /** A. */
  Matrix36d motion;
  /** N. */
  Matrix3d projector;
  /** f = N (p - q). */
  Vector3d force;
};

/** Motions whose share of the gradient's covariance is smaller are none that the
 * residuals see: round-off of a sum of squares. */
constexpr double min_relative_eigenvalue = 1e-12;

/** Second derivative of f . p(x), with p(x) = p + v + w x a + (w x (w x a) + w x v) / 2
 * + ... the moved point, a its arm. */
Matrix6d
curvatureOfMotion(const Vector3d& force, const Vector3d& arm)
{
  Matrix6d curvature = Matrix6d::Zero();
  curvature.topRightCorner<3, 3>() = 0.5 * crossMatrix(force);
  curvature.bottomLeftCorner<3, 3>() = -0.5 * crossMatrix(force);
  const Matrix3d product = force * arm.transpose();
  curvature.bottomRightCorner<3, 3>() =
      0.5 * (product + product.transpose()) - force.dot(arm) * Matrix3d::Identity();
  return curvature;
}

/** Pseudo-inverse of a covariance whose coordinates have different units. */
Matrix6d
scaledPseudoInverse(const Matrix6d& covariance)
{
  Vector6d scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  scale = (scale.array() > 0.0).select(scale, 1.0);
  const Matrix6d unscale = scale.cwiseInverse().asDiagonal();
  return unscale *
         pseudoInverse(Matrix6d(unscale * covariance * unscale),
                       min_relative_eigenvalue) *
         unscale;
}

} // namespace

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

ClosedFormDerivatives
closedFormDerivatives(const MatchedPoints& matches, const Vector3d& centre)
{
  const auto targetOf = [&](Index i) {
    return matches.target_indices[static_cast<std::size_t>(i)];
  };
  // Pairs of one target point become neighbours.
  std::vector<Index> order(matches.target_indices.size());
  std::iota(order.begin(), order.end(), Index(0));
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return targetOf(a) < targetOf(b);
  });
  ClosedFormDerivatives result;
  // Derivatives of the gradients A^T f of the pairs of a target point, by that point.
  Matrix63d of_target = Matrix63d::Zero();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const MatchedPair pair(matches, order[k], centre);
    result.gradient += pair.motion.transpose() * pair.force;
    result.hessian += pair.motion.transpose() * pair.projector * pair.motion +
                      curvatureOfMotion(pair.force, pair.arm);
    Matrix63d of_source = pair.motion.transpose() * pair.projector;
    of_target -= of_source;
    of_source.bottomRows<3>() -= crossMatrix(pair.force);
    result.gradient_covariance += of_source * of_source.transpose();
    if (k + 1 == order.size() || targetOf(order[k]) != targetOf(order[k + 1])) {
      result.gradient_covariance += of_target * of_target.transpose();
      of_target.setZero();
    }
  }
  return result;
}

Matrix6d
closedFormCovariance(const ClosedFormDerivatives& derivatives, double sigma)
{
  const Matrix6d inverse = derivatives.hessian.inverse();
  return sigma * sigma * inverse * derivatives.gradient_covariance *
         inverse.transpose();
}

GaussianInformation
closedFormInformation(const ClosedFormDerivatives& derivatives, double sigma)
{
  const Matrix6d gain = derivatives.hessian *
                        scaledPseudoInverse(derivatives.gradient_covariance) /
                        (sigma * sigma);
  const Matrix6d information = gain * derivatives.hessian;
  return {0.5 * (information + information.transpose()), gain * derivatives.gradient};
}

} // namespace bayesian_icp
