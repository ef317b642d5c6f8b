#include "baselines/closed_form_covariance.h"

#include "algebra/pseudo_inverse.h"
#include "baselines/matched_pair.h"

#include <algorithm>
#include <numeric>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

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

/** Derivative of a pair's gradient A^T f with respect to its moved source point. */
Matrix63d
sourceDerivative(const MatchedPair& pair)
{
  Matrix63d derivative = pair.motion.transpose() * pair.projector;
  derivative.bottomRows<3>() -= crossMatrix(pair.force);
  return derivative;
}

/** Derivative of a pair's gradient with respect to its target point. */
Matrix63d
targetDerivative(const MatchedPair& pair)
{
  return -pair.motion.transpose() * pair.projector;
}

/** Pairs in an order in which those of one target point are neighbours. */
std::vector<Index>
orderedByTarget(const MatchedPoints& matches)
{
  std::vector<Index> order(static_cast<std::size_t>(matches.moved.cols()));
  std::iota(order.begin(), order.end(), Index(0));
  const auto targetOf = [&](Index i) {
    return matches.target_indices[static_cast<std::size_t>(i)];
  };
  if (!matches.target_indices.empty())
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return targetOf(a) < targetOf(b);
    });
  return order;
}

bool
haveSameTarget(const MatchedPoints& matches, Index a, Index b)
{
  return !matches.target_indices.empty() &&
         matches.target_indices[static_cast<std::size_t>(a)] ==
             matches.target_indices[static_cast<std::size_t>(b)];
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

ClosedFormDerivatives
closedFormDerivatives(const MatchedPoints& matches, const Vector3d& centre)
{
  ClosedFormDerivatives result;
  const std::vector<Index> order = orderedByTarget(matches);
  Matrix63d of_target = Matrix63d::Zero();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const MatchedPair pair(matches, order[k], centre);
    result.gradient += pair.motion.transpose() * pair.force;
    result.hessian += pair.motion.transpose() * pair.projector * pair.motion +
                      curvatureOfMotion(pair.force, pair.arm);
    const Matrix63d of_source = sourceDerivative(pair);
    result.gradient_covariance += of_source * of_source.transpose();
    of_target += targetDerivative(pair);
    const bool is_last =
        k + 1 == order.size() || !haveSameTarget(matches, order[k], order[k + 1]);
    if (is_last) {
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
