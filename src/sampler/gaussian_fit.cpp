#include "sampler/gaussian_fit.h"

#include "algebra/decompositions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

/** Antithetic pairs of one chain and iteration. */
constexpr int num_pairs_alone = 10;
/** Noise of a pair's gradients that the regression tolerates, posterior sd = 1. */
constexpr double pair_noise_target = 4.0;
constexpr double min_pair_batch = 64.0;
/** Weight, in pairs, of the slope that the preconditioner predicts. */
constexpr double slope_ridge = 4.0;
constexpr double min_slope = 0.1, max_slope = 10.0;
constexpr double max_mean_step = 4.0;
constexpr double cooling_factor = 4.0;
constexpr int max_iterations_per_temperature = 6;
constexpr int max_last_iterations = 20;
/** Keeps a direction without a prior finite: a standard deviation of 30 m or rad. */
constexpr double least_prior_precision = 1e-3;

Matrix6d
withLeastPrior(const Matrix6d& prior_precision)
{
  return prior_precision + least_prior_precision * Matrix6d::Identity();
}

/** Applies \p f to the eigenvalues of \p precision in units of \p prior_precision. */
template <typename Function>
Matrix6d
mapRelativeToPrior(const Matrix6d& precision,
                   const Matrix6d& prior_precision,
                   const Function& f)
{
  const Matrix6d root = Eigen::LLT<Matrix6d>(prior_precision).matrixL();
  const Matrix6d inverse_root = root.inverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> relative(
      symmetrized(inverse_root * precision * inverse_root.transpose()));
  const Matrix6d basis = root * relative.eigenvectors();
  const Vector6d mapped = relative.eigenvalues().unaryExpr(f);
  return symmetrized(basis * mapped.asDiagonal() * basis.transpose());
}

Matrix6d
atLeastHalfThePrior(const Matrix6d& precision, const Matrix6d& prior_precision)
{
  return mapRelativeToPrior(precision, withLeastPrior(prior_precision), [](double e) {
    return std::max(0.5, e);
  });
}

double
largestEigenvalue(const Matrix6d& symmetric)
{
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(symmetric, Eigen::EigenvaluesOnly)
      .eigenvalues()[5];
}

/** Batch at which the noise of a pair's gradient is at its target. */
std::size_t
pairBatchSize(double term_noise, std::size_t num_terms)
{
  const double n = static_cast<double>(num_terms);
  const double size = term_noise / (pair_noise_target + term_noise / n);
  return static_cast<std::size_t>(
      std::min(n, std::max(min_pair_batch, std::ceil(size))));
}

/** The Gaussian of a quarter of the temperature. */
void
cool(const Matrix6d& prior_precision, GaussianFit& fit)
{
  const Matrix6d precision = mapRelativeToPrior(
      fit.gaussian.precision(), withLeastPrior(prior_precision), [](double e) {
        return std::max(0.5, cooling_factor * (e - 1.0) + 1.0);
      });
  fit.gaussian = Gaussian(fit.gaussian.mean(), precision);
  fit.temperature /= cooling_factor;
}

} // namespace

Gaussian::Gaussian(const Vector6d& mean, const Matrix6d& precision)
: mean_(mean)
, precision_(symmetrized(precision))
{
  const Eigen::LLT<Matrix6d> root(precision_);
  if (root.info() == Eigen::Success)
    inverse_factor_ = root.matrixU();
  else
    inverse_factor_.setConstant(std::numeric_limits<double>::quiet_NaN());
  factor_ = inverse_factor_.triangularView<Eigen::Upper>().solve(Matrix6d::Identity());
}

double
Gaussian::energy(const Vector6d& x) const
{
  return 0.5 * (inverse_factor_ * (x - mean_)).squaredNorm() -
         inverse_factor_.diagonal().array().log().sum();
}

RegressionSums&
RegressionSums::operator+=(const RegressionSums& other)
{
  num_pairs += other.num_pairs;
  mean_gradient += other.mean_gradient;
  gradient_position += other.gradient_position;
  position_position += other.position_position;
  gradient_gradient += other.gradient_gradient;
  num_noise_samples += other.num_noise_samples;
  term_noise += other.term_noise;
  pair_noise += other.pair_noise;
  return *this;
}

RegressionSums
collectGradients(StochasticEnergy& energy,
                 const GaussianFit& fit,
                 int num_pairs,
                 Random& random)
{
  const Vector6d& mean = fit.gaussian.mean();
  const Matrix6d& L = fit.gaussian.factor();
  RegressionSums sums;
  sums.num_pairs = num_pairs;
  sums.num_noise_samples = 3;
  for (int i = 0; i < sums.num_noise_samples; ++i) {
    const Vector6d x = i == 0 ? mean : fit.gaussian.draw(random);
    sums.term_noise += L.transpose() * energy.termCovariance(x, random) * L;
  }
  const Matrix6d tempered_noise = sums.term_noise / (fit.temperature * fit.temperature);
  const double n = static_cast<double>(energy.numTerms());
  const std::size_t batch = pairBatchSize(
      largestEigenvalue(tempered_noise) / sums.num_noise_samples, energy.numTerms());
  sums.pair_noise = tempered_noise * (1.0 / static_cast<double>(batch) - 1.0 / n);

  const auto gradientAt = [&](const Vector6d& x) -> Vector6d {
    const SplitGradient g = energy.gradient(x, batch, random);
    return L.transpose() * (g.likelihood / fit.temperature + g.prior);
  };
  for (int i = 0; i < num_pairs; ++i) {
    const Vector6d z = random.normal6();
    const Vector6d plus = gradientAt(mean + L * z);
    const Vector6d minus = gradientAt(mean - L * z);
    sums.mean_gradient += 0.5 * (plus + minus);
    sums.gradient_position += 0.5 * (plus - minus) * z.transpose();
    sums.position_position += z * z.transpose();
    sums.gradient_gradient += plus * plus.transpose() + minus * minus.transpose();
  }
  return sums;
}

void
updateFit(const RegressionSums& sums,
          double gain,
          const Matrix6d& prior_precision,
          GaussianFit& fit)
{
  const double num_pairs = sums.num_pairs;
  const Matrix6d pair_noise = sums.pair_noise / sums.num_noise_samples;
  const Matrix6d ridge = slope_ridge * Matrix6d::Identity();
  const Matrix6d slope = symmetrized((sums.gradient_position + ridge) *
                                     (sums.position_position + ridge).inverse());
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(slope);
  const Vector6d clipped = solver.eigenvalues().cwiseMax(min_slope).cwiseMin(max_slope);
  const Matrix6d& basis = solver.eigenvectors();

  const Vector6d mean_gradient = sums.mean_gradient / num_pairs;
  Vector6d step = -(basis * clipped.cwiseInverse().asDiagonal() *
                    (basis.transpose() * mean_gradient));
  step *= std::min(1.0, max_mean_step / std::max(step.norm(), 1e-12));

  // Residual covariance of the single gradients about mean gradient +- slope z.
  const Matrix6d cross = 2.0 * slope * sums.gradient_position.transpose();
  const Matrix6d residual =
      (sums.gradient_gradient -
       2.0 * num_pairs * mean_gradient * mean_gradient.transpose() - cross -
       cross.transpose() + 2.0 * slope * sums.position_position * slope.transpose()) /
      std::max(1.0, 2.0 * num_pairs - 7.0);

  const Matrix6d inverse_factor = fit.gaussian.inverseFactor();
  const auto toEnergyUnits = [&](const Matrix6d& m) -> Matrix6d {
    return symmetrized(inverse_factor.transpose() * m * inverse_factor);
  };
  fit.term_covariance = toEnergyUnits(sums.term_noise / sums.num_noise_samples);
  fit.nonlinearity = toEnergyUnits(residual - pair_noise);
  const Matrix6d new_slope = basis * clipped.asDiagonal() * basis.transpose();
  const Matrix6d precision =
      toEnergyUnits((1.0 - gain) * Matrix6d::Identity() + gain * new_slope);
  fit.has_converged =
      step.norm() < 0.7 + 0.5 * std::sqrt(pair_noise.trace() / num_pairs) &&
      clipped.maxCoeff() < 1.8 && clipped.minCoeff() > 0.55;
  fit.gaussian = Gaussian(fit.gaussian.mean() + gain * (fit.gaussian.factor() * step),
                          atLeastHalfThePrior(precision, prior_precision));
}

GaussianFit
fitTempered(StochasticEnergy& energy,
            const Vector6d& start,
            Random& random,
            const std::function<bool()>& keep_going)
{
  const Matrix6d prior = energy.priorPrecision();
  const Matrix6d curvature = energy.roughCurvature(start);
  const Gaussian untempered(start, atLeastHalfThePrior(curvature + prior, prior));
  GaussianFit fit;
  fit.temperature = energy.initialTemperature(start, untempered.covariance());
  fit.gaussian =
      Gaussian(start, atLeastHalfThePrior(curvature / fit.temperature + prior, prior));

  int at_this_temperature = 0;
  while (keep_going()) {
    ++at_this_temperature;
    updateFit(collectGradients(energy, fit, num_pairs_alone, random),
              at_this_temperature < 4 ? 1.0 : 0.6,
              prior,
              fit);
    const bool is_done =
        (at_this_temperature >= 2 && fit.has_converged) ||
        at_this_temperature >= (fit.temperature > 1.0 ? max_iterations_per_temperature
                                                      : max_last_iterations);
    if (is_done && fit.temperature <= 1.0)
      break;
    if (is_done) {
      cool(prior, fit);
      at_this_temperature = 0;
    }
  }
  return fit;
}

} // namespace bayesian_icp
