#include "calibrated/draws/draw_plan.h"

#include "algebra/decompositions.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/** Numbers of positions, and of points at each position, at which the noise of a
 * point's score is measured. */
constexpr int num_noise_positions = 24, num_noise_points = 32;

constexpr double max_step_size = 0.75;

constexpr std::size_t batch_size = 32;

/** Number of effective draws along the slowest direction that one draw should be worth.
 * The rest is a margin for tails and for shapes that are not Gaussian. */
constexpr double wanted_ess_share = 0.6;

/** Steps that a draw may take: 96 queries. */
constexpr int max_thinning = 3;

/** Variance of a batch's gradient, in units of the posterior sd, at which steps are
 * long enough for max_thinning and wanted_ess_share. */
constexpr double max_noise = 2.0;

/** Integrated autocorrelation time of every \p thinning-th position on a Gaussian:
 * after one step the correlation is 1 - b/2 (the noise of two steps is shared), then it
 * shrinks by 1 - b a step. */
double
autocorrelationTime(double step_size, int thinning)
{
  const double decay = std::pow(1.0 - step_size, thinning - 1);
  return 1.0 +
         2.0 * (1.0 - 0.5 * step_size) * decay / (1.0 - decay * (1.0 - step_size));
}

int
thinningFor(double step_size)
{
  int thinning = 1;
  while (thinning < max_thinning &&
         autocorrelationTime(step_size, thinning) * wanted_ess_share > 1.0)
    ++thinning;
  return thinning;
}

/** The matrix that brings the noise of gradients, of covariance \p noise, down to
 * max_noise where it is larger. */
Matrix6d
gainFor(const Matrix6d& noise, const Gaussian& gaussian)
{
  const Matrix6d& L = gaussian.factor();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(
      Matrix6d(L.transpose() * noise * L));
  const Vector6d gains =
      (max_noise * solver.eigenvalues().cwiseMax(max_noise).cwiseInverse()).cwiseSqrt();
  const Matrix6d& U = solver.eigenvectors();
  return gaussian.inverseFactor().transpose() * U * gains.asDiagonal() * U.transpose() *
         L.transpose();
}

/** Limits of the factor that changes a direction's spread. */
constexpr double min_spread_factor = 0.7, max_spread_factor = 1.4;

/** The symmetric map, in units of \p wanted, that brings one covariance to the other.
 */
MatrixXd
mapBetween(const MatrixXd& covariance, const MatrixXd& wanted)
{
  const MatrixXd L = wanted.llt().matrixL();
  const MatrixXd inverse = L.triangularView<Eigen::Lower>().solve(
      MatrixXd::Identity(wanted.rows(), wanted.cols()));
  const Eigen::SelfAdjointEigenSolver<MatrixXd> ratio(
      MatrixXd(inverse * covariance * inverse.transpose()));
  const VectorXd factors = ratio.eigenvalues()
                               .cwiseMax(1e-6)
                               .cwiseSqrt()
                               .cwiseInverse()
                               .cwiseMax(min_spread_factor)
                               .cwiseMin(max_spread_factor);
  return L * ratio.eigenvectors() * factors.asDiagonal() *
         ratio.eigenvectors().transpose() * inverse;
}

Index
numDrawsOf(const std::vector<Path>& paths)
{
  Index num_draws = 0;
  for (const Path& path : paths)
    num_draws += path.positions.cols();
  return num_draws;
}

/** b, the last rows, of every chain that has draws. A run may end before all chains
 * have any, and Eigen has no rows of a matrix without columns. */
std::vector<Eigen::Block<Matrix6Xd>>
heldParts(std::vector<Path>& paths, Index num_held)
{
  std::vector<Eigen::Block<Matrix6Xd>> parts;
  for (Path& path : paths)
    if (path.positions.cols() > 0)
      parts.emplace_back(
          path.positions, 6 - num_held, 0, num_held, path.positions.cols());
  return parts;
}

/** Mean of b over all chains. */
VectorXd
meanOfHeld(std::vector<Path>& paths, Index num_held)
{
  VectorXd sum = VectorXd::Zero(num_held);
  for (const auto& held : heldParts(paths, num_held))
    sum += held.rowwise().sum();
  return sum / static_cast<double>(numDrawsOf(paths));
}

double
chiSquared(int degrees_of_freedom, Random& random)
{
  double sum = 0.0;
  for (int i = 0; i < degrees_of_freedom; ++i) {
    const double z = random.normal();
    sum += z * z;
  }
  return sum;
}

} // namespace

StepPlan
planDraws(WeightedScore& score, Random& random)
{
  const std::size_t num_terms = std::max<std::size_t>(1, score.numTerms());
  const double share = 1.0 / static_cast<double>(std::min(batch_size, num_terms)) -
                       1.0 / static_cast<double>(num_terms);
  const Matrix6d covariance =
      score.termCovariance(num_noise_positions, num_noise_points, random);
  GaussianFit fit;
  fit.gaussian = score.coordinates().gaussian();
  const Matrix6d gain = gainFor(share * covariance, fit.gaussian);
  score.setShapeGain(gain);
  fit.term_covariance = gain * covariance * gain.transpose();
  StepPlan plan = planSteps(fit, num_terms, batch_size, max_step_size);
  plan.thinning = thinningFor(plan.step_sizes.minCoeff());
  return plan;
}

void
spreadAsEstimated(const ProductCoordinates& coordinates, std::vector<Path>& paths)
{
  const Index num_held = 6 - coordinates.numPriorOnly();
  const Index num_draws = numDrawsOf(paths);
  if (num_held == 0 || num_draws <= num_held)
    return;
  const VectorXd mean = meanOfHeld(paths, num_held);
  MatrixXd covariance = MatrixXd::Zero(num_held, num_held);
  for (auto& held : heldParts(paths, num_held)) {
    held.colwise() -= mean;
    covariance += held * held.transpose();
  }
  covariance /= static_cast<double>(num_draws - 1);
  const Matrix6d wanted = coordinates.gaussian().covariance();
  const MatrixXd map =
      mapBetween(covariance, wanted.bottomRightCorner(num_held, num_held));
  for (auto& held : heldParts(paths, num_held))
    held = ((map * held).colwise() + mean).eval();
}

void
scaleAtRandom(const ProductCoordinates& coordinates,
              int degrees_of_freedom,
              Random& random,
              std::vector<Path>& paths)
{
  const Index num_held = 6 - coordinates.numPriorOnly();
  if (degrees_of_freedom == 0 || num_held == 0 || numDrawsOf(paths) == 0)
    return;
  const VectorXd mean = meanOfHeld(paths, num_held);
  for (Path& path : paths)
    for (Index i = 0; i < path.positions.cols(); ++i) {
      const double scale =
          std::sqrt((degrees_of_freedom - 2) / chiSquared(degrees_of_freedom, random));
      auto held = path.positions.col(i).tail(num_held);
      held = (mean + scale * (held - mean)).eval();
    }
}

} // namespace bayesian_icp
