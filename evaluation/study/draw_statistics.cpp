#include "study/draw_statistics.h"

#include "algebra/decompositions.h"
#include "io/picture_numbers.h"
#include "sampler/t_mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bayesian_icp::evaluate {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/** All pairs of this number of draws give the energy score's second term. */
constexpr Eigen::Index num_paired_draws = 400;

double
logDeterminant(const Eigen::LLT<Matrix6d>& llt)
{
  return 2.0 * llt.matrixLLT().diagonal().array().log().sum();
}

} // namespace

Moments
momentsOf(const PoseMatrix& draws)
{
  return {draws.colwise().mean().transpose(), covarianceOf(draws)};
}

PoseMatrix
unwrapAbout(const Vector6d& centre, const PoseMatrix& draws)
{
  PoseMatrix unwrapped = draws;
  for (Eigen::Index row = 0; row < draws.rows(); ++row)
    for (int k = 3; k < 6; ++k)
      unwrapped(row, k) = centre[k] + wrapAngle(draws(row, k) - centre[k]);
  return unwrapped;
}

std::optional<Matrix6d>
factorOf(const Matrix6d& covariance)
{
  // In units of its own standard deviations it is as well conditioned as can be.
  const Vector6d sd = covariance.diagonal().cwiseSqrt();
  const Matrix6d correlation =
      sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal();
  const Eigen::LLT<Matrix6d> cholesky(correlation);
  if (!correlation.allFinite() || cholesky.info() != Eigen::Success)
    return std::nullopt;
  return sd.asDiagonal() * Matrix6d(cholesky.matrixL());
}

double
gaussianKl(const Moments& p, const Moments& q)
{
  // In units of q's standard deviations: metres and radians then do no harm.
  const Vector6d scale = q.covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite())
    return infinity;
  const Matrix6d p_cov = scale.asDiagonal() * p.covariance * scale.asDiagonal();
  const Matrix6d q_cov = scale.asDiagonal() * q.covariance * scale.asDiagonal();
  const Eigen::LLT<Matrix6d> p_llt(p_cov), q_llt(q_cov);
  if (p_llt.info() != Eigen::Success || q_llt.info() != Eigen::Success)
    return infinity;
  const Vector6d shift = scale.cwiseProduct(q.mean - p.mean);
  return 0.5 * (q_llt.solve(p_cov).trace() + shift.dot(q_llt.solve(shift)) - 6.0 +
                logDeterminant(q_llt) - logDeterminant(p_llt));
}

double
gaussianKl(const Moments& p, const Moments& q, int k)
{
  const double p_var = p.covariance(k, k), q_var = q.covariance(k, k);
  const double shift = q.mean[k] - p.mean[k];
  if (!(q_var > 0.0))
    return infinity;
  return 0.5 * (p_var / q_var + shift * shift / q_var - 1.0 + std::log(q_var / p_var));
}

SampleDistance
distanceBetween(Eigen::VectorXd a, Eigen::VectorXd b)
{
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  SampleDistance distance;
  double value = -infinity;
  for (Eigen::Index i = 0, j = 0;;) {
    const double next = std::min(i < a.size() ? a[i] : infinity, //
                                 j < b.size() ? b[j] : infinity);
    const double difference =
        std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                 static_cast<double>(j) / static_cast<double>(b.size()));
    distance.kolmogorov_smirnov = std::max(distance.kolmogorov_smirnov, difference);
    if (next == infinity)
      return distance;
    if (i + j > 0)
      distance.wasserstein += (next - value) * difference;
    value = next;
    while (i < a.size() && a[i] <= value)
      ++i;
    while (j < b.size() && b[j] <= value)
      ++j;
  }
}

double
energyScore(const PoseMatrix& draws, const PoseMatrix& outcomes)
{
  double to_outcomes = 0.0;
  for (Eigen::Index i = 0; i < outcomes.rows(); ++i)
    to_outcomes += (draws.rowwise() - outcomes.row(i)).rowwise().norm().mean();
  const PoseMatrix paired =
      draws(io::evenlySpaced(draws.rows(), num_paired_draws), Eigen::all);
  const Eigen::Index num_paired = paired.rows();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < num_paired; ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      sum += (paired.row(i) - paired.row(j)).norm();
  const Eigen::Index num_pairs = num_paired * (num_paired - 1) / 2;
  return to_outcomes / static_cast<double>(outcomes.rows()) -
         0.5 * sum / static_cast<double>(num_pairs);
}

double
median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle]
                           : 0.5 * (values[middle - 1] + values[middle]);
}

double
mean(std::vector<double> values)
{
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(values.size());
}

double
smallest(std::vector<double> values)
{
  return *std::min_element(values.begin(), values.end());
}

double
largest(std::vector<double> values)
{
  return *std::max_element(values.begin(), values.end());
}

} // namespace bayesian_icp::evaluate
