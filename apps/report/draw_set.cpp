#include "report/draw_set.h"

#include "io/coordinates.h"
#include "register/report_text.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::app {

namespace {

/** Differences below this are none [m, rad]. */
constexpr double rounding = 1e-12;

Axis
axisOf(int k, const CoordinateSummary& coordinate, double mean)
{
  Axis axis;
  axis.name = coordinate_names[k];
  const LengthUnit unit = unitFor(coordinate.standard_deviation);
  axis.unit = isAngle(k) ? "°" : unit.name;
  axis.factor = isAngle(k) ? degrees_per_radian : unit.per_metre;
  axis.standard_deviation = axis.factor * coordinate.standard_deviation;
  axis.quantile_2_5 = axis.factor * (coordinate.quantile_2_5 - mean);
  axis.quantile_97_5 = axis.factor * (coordinate.quantile_97_5 - mean);
  return axis;
}

Eigen::MatrixXd
errorsOf(const PoseMatrix& draws, const Vector6d& mean, const DrawSet& set)
{
  Eigen::MatrixXd errors(draws.rows(), 6);
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const Vector6d error =
        poseError(draws.row(i).transpose(), mean, CovarianceConvention::Parameters);
    for (int k = 0; k < 6; ++k)
      errors(i, k) =
          std::abs(error[k]) < rounding ? 0.0 : set.axes[k].factor * error[k];
  }
  return errors;
}

} // namespace

std::string
differenceLabel(const Axis& axis)
{
  return axis.name + " − mean [" + axis.unit + ']';
}

DrawSet
drawSetOf(const RegistrationResult& result)
{
  DrawSet set;
  const Vector6d mean = meanPoseCoordinates(result.summary);
  for (int k = 0; k < 6; ++k)
    set.axes[k] = axisOf(k, result.summary.coordinates[k], mean[k]);
  for (std::size_t i = 0; i < result.chains.size(); ++i) {
    const Chain& chain = result.chains[i];
    if (!chain.diverged && chain.draws.rows() > 0)
      set.chains.push_back({static_cast<int>(i), errorsOf(chain.draws, mean, set)});
  }
  return set;
}

Eigen::VectorXd
pooledErrors(const DrawSet& draws, int coordinate)
{
  Eigen::Index num_draws = 0;
  for (const ChainDraws& chain : draws.chains)
    num_draws += chain.errors.rows();
  Eigen::VectorXd errors(num_draws);
  Eigen::Index filled = 0;
  for (const ChainDraws& chain : draws.chains) {
    errors.segment(filled, chain.errors.rows()) = chain.errors.col(coordinate);
    filled += chain.errors.rows();
  }
  return errors;
}

std::vector<Eigen::VectorXd>
ranksOf(const DrawSet& draws, int coordinate)
{
  Eigen::VectorXd sorted = pooledErrors(draws, coordinate);
  std::sort(sorted.data(), sorted.data() + sorted.size());
  const auto rankOf = [&sorted](double value) {
    const auto [first, last] =
        std::equal_range(sorted.data(), sorted.data() + sorted.size(), value);
    const auto below = static_cast<double>(first - sorted.data());
    return below + 0.5 * static_cast<double>(last - first - 1);
  };
  std::vector<Eigen::VectorXd> ranks;
  for (const ChainDraws& chain : draws.chains)
    ranks.push_back(chain.errors.col(coordinate).unaryExpr(rankOf));
  return ranks;
}

double
kernelWidth(const DrawSet& draws, int coordinate)
{
  constexpr double silverman = 1.06;
  const auto squaresOf = [](const auto& errors) {
    return (errors.array() - errors.mean()).square().sum();
  };
  double sum_of_squares = 0.0;
  for (const ChainDraws& chain : draws.chains)
    sum_of_squares += squaresOf(chain.errors.col(coordinate));
  const Eigen::VectorXd errors = pooledErrors(draws, coordinate);
  // The mean of equal numbers is rounded.
  constexpr double rounding = 1e-20;
  const double of_all = squaresOf(errors);
  if (sum_of_squares <= rounding * of_all)
    sum_of_squares = of_all;
  const auto num = static_cast<double>(errors.size());
  return silverman * std::sqrt(sum_of_squares / num) * std::pow(num, -0.2);
}

} // namespace bayesian_icp::app
