#include "sampler/stein.h"

#include "algebra/decompositions.h"
#include "sampler/median.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

/** The particles' kernel. */
struct Kernel {
  explicit Kernel(const ParticleMatrix& x)
  {
    const Eigen::VectorXd norms = x.colwise().squaredNorm().transpose();
    values = -2.0 * x.transpose().lazyProduct(x);
    values.colwise() += norms;
    values.rowwise() += norms.transpose();
    std::vector<double> squared_distances;
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        squared_distances.push_back(values(j, i));
    width = std::max(medianOf(squared_distances), std::numeric_limits<double>::min()) /
            std::log(static_cast<double>(x.cols()) + 1.0);
    values = (-values / width).array().exp();
  }

  /** grad k(x_j, x_i) by x_j, for all j. */
  ParticleMatrix
  gradients(const ParticleMatrix& x, Eigen::Index i) const
  {
    return (2.0 / width) * ((-x).colwise() + x.col(i)) * values.col(i).asDiagonal();
  }

  /** h. */
  double width;
  /** k(x_j, x_i). */
  Eigen::MatrixXd values;
};

/** n phi. The products are lazy, as Eigen's others start threads of their own. */
ParticleMatrix
sumOfForces(const Kernel& kernel, const ParticleMatrix& x, const ParticleMatrix& g)
{
  const double rate = 2.0 / kernel.width;
  const Eigen::VectorXd mass = kernel.values.colwise().sum().transpose();
  const ParticleMatrix pull = g + rate * x;
  return rate * x * mass.asDiagonal() - pull.lazyProduct(kernel.values);
}

} // namespace

ParticleMatrix
steinGradientSteps(const ParticleMatrix& positions, const ParticleMatrix& gradients)
{
  const Kernel kernel(positions);
  const Eigen::VectorXd mass = kernel.values.colwise().sum().transpose();
  return sumOfForces(kernel, positions, gradients) * mass.cwiseInverse().asDiagonal();
}

ParticleMatrix
steinNewtonSteps(const ParticleMatrix& positions,
                 const ParticleMatrix& gradients,
                 const std::vector<Matrix6d>& curvatures)
{
  const Kernel kernel(positions);
  ParticleMatrix steps = sumOfForces(kernel, positions, gradients);
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    const ParticleMatrix forces = kernel.gradients(positions, i);
    Matrix6d H = forces * forces.transpose();
    for (Eigen::Index j = 0; j < positions.cols(); ++j)
      H += std::pow(kernel.values(j, i), 2) * curvatures[static_cast<std::size_t>(j)];
    steps.col(i) = H.ldlt().solve(steps.col(i)).eval();
  }
  return steps;
}

SteinDiscrepancy
steinDiscrepancy(const ParticleMatrix& positions, const ParticleMatrix& gradients)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(positions.cols());
  const ParticleMatrix errors = positions.colwise() - positions.rowwise().mean();
  const Eigen::LLT<Matrix6d> llt(Matrix6d(errors * errors.transpose() / n));
  if (!positions.allFinite() || llt.info() != Eigen::Success)
    return {nan, nan};
  const Matrix6d L = llt.matrixL();
  const ParticleMatrix z = llt.matrixL().solve(errors);
  const ParticleMatrix g = L.transpose() * gradients;
  const Matrix6d moments = g * z.transpose() / n;
  const Vector6d mean = g.rowwise().mean();
  return {
      std::sqrt(mean.squaredNorm() + (Matrix6d::Identity() - moments).squaredNorm()),
      moments.trace() / 6.0};
}

} // namespace bayesian_icp
