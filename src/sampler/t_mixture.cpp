#include "sampler/t_mixture.h"

#include <cmath>

namespace bayesian_icp {

Matrix6d
covarianceOf(const PoseMatrix& draws)
{
  const PoseMatrix centred = draws.rowwise() - draws.colwise().mean();
  return centred.transpose() * centred / static_cast<double>(draws.rows() - 1);
}

namespace {

constexpr int num_iterations = 40;
constexpr double degrees_of_freedom = 8.0;
/** Share of the whole draws' covariance in each component: none can become singular. */
constexpr double regularisation = 1e-6;
/** Draws from which a covariance in six dimensions is worth having. */
constexpr double min_draws = 60.0;

/** log Gamma((nu + 6) / 2) - log Gamma(nu / 2) - 3 log(nu pi): of the standard t. */
const double log_normalisation = std::lgamma(0.5 * (degrees_of_freedom + 6.0)) -
                                 std::lgamma(0.5 * degrees_of_freedom) -
                                 3.0 * std::log(degrees_of_freedom * M_PI);

double
logSumExp(const Eigen::VectorXd& values)
{
  const double largest = values.maxCoeff();
  return largest + std::log((values.array() - largest).exp().sum());
}

/** Every draw belongs to the nearest of randomly chosen centres, in units of the
 * covariance of all. */
Eigen::MatrixXd
randomShares(const PoseMatrix& draws, int num_components, Random& random)
{
  const Eigen::LLT<Matrix6d> llt(covarianceOf(draws));
  const Eigen::MatrixXd whitened = llt.matrixL().solve(draws.transpose());
  const auto num_draws = static_cast<std::size_t>(draws.rows());
  Eigen::MatrixXd centres(6, num_components);
  for (int j = 0; j < num_components; ++j)
    centres.col(j) = whitened.col(static_cast<Eigen::Index>(random.index(num_draws)));
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(draws.rows(), num_components);
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    Eigen::Index nearest;
    (centres.colwise() - whitened.col(i)).colwise().squaredNorm().minCoeff(&nearest);
    shares(i, nearest) = 1.0;
  }
  return shares;
}

} // namespace

TMixture::TMixture(const PoseMatrix& draws, int num_components, Random& random)
{
  maximise(draws, randomShares(draws, num_components, random));
  for (int iteration = 0; iteration < num_iterations; ++iteration)
    maximise(draws, responsibilities(draws));
}

TMixture::Component
TMixture::makeComponent(const Vector6d& mean,
                        const Matrix6d& covariance,
                        double log_weight)
{
  Component c;
  c.log_weight = log_weight;
  c.mean = mean;
  c.covariance.compute(covariance);
  c.log_determinant = 2.0 * c.covariance.matrixLLT().diagonal().array().log().sum();
  return c;
}

void
TMixture::add(const Vector6d& mean, const Matrix6d& covariance, double weight)
{
  for (Component& c : components_)
    c.log_weight += std::log1p(-weight);
  components_.push_back(
      makeComponent(mean, covariance, components_.empty() ? 0.0 : std::log(weight)));
}

Matrix6d
TMixture::covarianceWithin() const
{
  Matrix6d sum = Matrix6d::Zero();
  for (const Component& c : components_)
    sum += std::exp(c.log_weight) * c.covariance.reconstructedMatrix();
  return sum;
}

double
TMixture::squaredDistance(const Component& component, const Vector6d& x)
{
  return component.covariance.matrixL().solve(x - component.mean).squaredNorm();
}

Eigen::MatrixXd
TMixture::responsibilities(const PoseMatrix& draws) const
{
  const auto num_components = static_cast<Eigen::Index>(components_.size());
  Eigen::MatrixXd shares(draws.rows(), num_components);
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const Vector6d x = draws.row(i).transpose();
    Eigen::VectorXd logs(num_components);
    for (Eigen::Index j = 0; j < num_components; ++j) {
      const Component& c = components_[static_cast<std::size_t>(j)];
      logs[j] = c.log_weight - 0.5 * (squaredDistance(c, x) + c.log_determinant);
    }
    shares.row(i) = (logs.array() - logSumExp(logs)).exp().transpose();
  }
  return shares;
}

void
TMixture::maximise(const PoseMatrix& draws, const Eigen::MatrixXd& shares)
{
  components_.clear();
  const Matrix6d floor = regularisation * covarianceOf(draws);
  double total_weight = 0.0;
  for (Eigen::Index j = 0; j < shares.cols(); ++j) {
    const double weight = shares.col(j).sum();
    if (weight < min_draws && shares.cols() > 1)
      continue;
    const Vector6d mean = draws.transpose() * shares.col(j) / weight;
    const PoseMatrix centred = draws.rowwise() - mean.transpose();
    const Matrix6d covariance =
        centred.transpose() * shares.col(j).asDiagonal() * centred / weight;
    components_.push_back(makeComponent(mean, covariance + floor, std::log(weight)));
    total_weight += weight;
  }
  if (components_.empty())
    return maximise(draws, Eigen::MatrixXd::Ones(draws.rows(), 1));
  for (Component& c : components_)
    c.log_weight -= std::log(total_weight);
}

Vector6d
TMixture::draw(Random& random) const
{
  double u = random.uniform();
  std::size_t j = 0;
  while (j + 1 < components_.size() && u >= std::exp(components_[j].log_weight))
    u -= std::exp(components_[j++].log_weight);
  double chi_squared = 0.0;
  for (int i = 0; i < static_cast<int>(degrees_of_freedom); ++i)
    chi_squared += std::pow(random.normal(), 2);
  const Vector6d z = random.normal6() / std::sqrt(chi_squared / degrees_of_freedom);
  return components_[j].mean + components_[j].covariance.matrixL() * z;
}

double
TMixture::logDensity(const Vector6d& x) const
{
  Eigen::VectorXd logs(static_cast<Eigen::Index>(components_.size()));
  for (std::size_t j = 0; j < components_.size(); ++j) {
    const Component& c = components_[j];
    logs[static_cast<Eigen::Index>(j)] =
        c.log_weight - 0.5 * c.log_determinant -
        0.5 * (degrees_of_freedom + 6.0) *
            std::log1p(squaredDistance(c, x) / degrees_of_freedom);
  }
  return log_normalisation + logSumExp(logs);
}

} // namespace bayesian_icp
