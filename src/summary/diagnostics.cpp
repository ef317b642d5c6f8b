// The functions rhat, ess_bulk, ess_tail and mcse_mean of R's package posterior, with
// whose results the test compares. Two differences, both NaN here: an infinite draw,
// which posterior ranks like any number, and two or three draws per chain, where its
// rhat confuses draws with chains.
#include <bayesian_icp/diagnostics.h>

#include <unsupported/Eigen/FFT>
#include <unsupported/Eigen/SpecialFunctions>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double not_defined = std::numeric_limits<double>::quiet_NaN();

/** \brief Empty, not finite, or constant up to posterior's (absolute) tolerance. */
bool
isDegenerate(const MatrixXd& x)
{
  return x.size() == 0 || !x.allFinite() ||
         x.maxCoeff() - x.minCoeff() < std::numeric_limits<double>::epsilon();
}

VectorXd
flatten(const MatrixXd& x)
{
  return Eigen::Map<const VectorXd>(x.data(), x.size());
}

/** \brief Unbiased variance; the shift makes it exactly 0 for equal values. */
double
variance(const VectorXd& x)
{
  const VectorXd shifted = x.array() - x(0);
  return (shifted.array() - shifted.mean()).square().sum() /
         static_cast<double>(x.size() - 1);
}

MatrixXd
splitChains(const MatrixXd& x)
{
  const Index half = x.rows() / 2;
  MatrixXd halves(half, 2 * x.cols());
  halves << x.topRows(half), x.bottomRows(half);
  return halves;
}

/** \brief Distances from the median. They turn a difference in scale into one in
 * location. */
MatrixXd
foldAboutMedian(const MatrixXd& x)
{
  return (x.array() - quantile(flatten(x), 0.5)).abs();
}

/** \brief Standard normal scores of the ranks (offset of Blom; ties share a rank). */
MatrixXd
normalScores(const MatrixXd& x)
{
  const double* value = x.data();
  std::vector<Index> order(static_cast<std::size_t>(x.size()));
  std::iota(order.begin(), order.end(), Index(0));
  std::sort(order.begin(), order.end(), [value](Index a, Index b) {
    return value[a] < value[b];
  });
  MatrixXd scores(x.rows(), x.cols());
  for (auto first = order.begin(); first != order.end();) {
    const auto last = std::find_if(
        first, order.end(), [&](Index i) { return value[i] != value[*first]; });
    const auto sum_of_ends = (first - order.begin()) + 1 + (last - order.begin());
    const double rank = 0.5 * static_cast<double>(sum_of_ends);
    const double score =
        Eigen::numext::ndtri((rank - 0.375) / (static_cast<double>(x.size()) + 0.25));
    for (; first != last; ++first)
      scores.data()[*first] = score;
  }
  return scores;
}

/** \brief R-hat of the columns as they are. */
double
potentialScaleReduction(const MatrixXd& x)
{
  if (isDegenerate(x))
    return not_defined;
  const double n = static_cast<double>(x.rows());
  double within = 0.0;
  for (Index chain = 0; chain < x.cols(); ++chain)
    within += variance(x.col(chain)) / static_cast<double>(x.cols());
  const double between = n * variance(x.colwise().mean().transpose());
  return std::sqrt((between / within + n - 1.0) / n);
}

/** \brief Autocovariance at every lag, averaged over the columns, which have mean 0.
 *
 * By Fourier transform; twice the length in zeros keeps the ends apart. The transform
 * is linear, so that one inverse serves the sum over the columns. */
VectorXd
meanAutocovariance(const MatrixXd& x)
{
  Index length = 1;
  while (length < 2 * x.rows())
    length *= 2;
  Eigen::FFT<double> fft;
  VectorXd padded = VectorXd::Zero(length);
  Eigen::VectorXcd transform;
  Eigen::VectorXcd power = Eigen::VectorXcd::Zero(length);
  for (Index chain = 0; chain < x.cols(); ++chain) {
    padded.head(x.rows()) = x.col(chain);
    fft.fwd(transform, padded);
    power.real() += transform.cwiseAbs2();
  }
  VectorXd products;
  fft.inv(products, power);
  return products.head(x.rows()) / static_cast<double>(x.size());
}

/** \brief Integrated autocorrelation time by Geyer's initial monotone sequence.
 * \param[in] rho autocorrelation at lags 0, 1, ...; three or more, the first one is 1
 */
double
autocorrelationTime(VectorXd rho)
{
  const auto pair = [&rho](Index lag) { return rho(lag) + rho(lag + 1); };
  Index last = 0;
  while (last < rho.size() - 5 && pair(last) > 0.0)
    last += 2;
  // Half of the pair that ended the sequence still counts: less bias for antithetic
  // chains, whose even lags are positive.
  if (rho(last) <= 0.0 && pair(last) < 0.0)
    rho(last) = 0.0;
  for (Index lag = 2; lag < last; lag += 2)
    if (pair(lag) > pair(lag - 2))
      rho.segment<2>(lag).setConstant(0.5 * pair(lag - 2));
  // posterior's sum has one term at least, hence tau = 2 if the first pair ends it.
  return 2.0 * rho.head(std::max<Index>(last, 1)).sum() - 1.0 + rho(last);
}

/** \brief Effective sample size of the columns as they are. */
double
effectiveSampleSize(const MatrixXd& x)
{
  if (x.rows() < 3 || isDegenerate(x))
    return not_defined;
  // Centred twice: a large common offset would cost digits of the chain means.
  MatrixXd centred = x.array() - x.mean();
  const Eigen::RowVectorXd means = centred.colwise().mean();
  centred.rowwise() -= means;
  const VectorXd covariance = meanAutocovariance(centred);
  const double n = static_cast<double>(x.rows());
  const double within = covariance(0) * n / (n - 1.0);
  const double total = covariance(0) + variance(means.transpose());
  VectorXd rho = 1.0 - (within - covariance.array()) / total;
  rho(0) = 1.0;
  const double size = static_cast<double>(x.size());
  return size / std::max(autocorrelationTime(rho), 1.0 / std::log10(size));
}

/** \brief Effective sample size of the share of draws below a quantile. */
double
quantileEss(const MatrixXd& draws, double probability)
{
  const double limit = quantile(flatten(draws), probability);
  const MatrixXd below = (draws.array() <= limit).cast<double>();
  return effectiveSampleSize(splitChains(below));
}

/** \brief The common NaN rule: std::max and std::min would drop a NaN. */
bool
anyNan(double a, double b)
{
  return std::isnan(a) || std::isnan(b);
}

} // namespace

double
rhat(const MatrixXd& draws)
{
  if (draws.rows() < 4 || draws.cols() == 0 || !draws.allFinite())
    return not_defined;
  const double bulk = potentialScaleReduction(normalScores(splitChains(draws)));
  const double folded =
      potentialScaleReduction(normalScores(splitChains(foldAboutMedian(draws))));
  return anyNan(bulk, folded) ? not_defined : std::max(bulk, folded);
}

double
bulkEss(const MatrixXd& draws)
{
  if (draws.size() == 0 || !draws.allFinite())
    return not_defined;
  return effectiveSampleSize(normalScores(splitChains(draws)));
}

double
tailEss(const MatrixXd& draws)
{
  if (isDegenerate(draws))
    return not_defined;
  const double low = quantileEss(draws, 0.05);
  const double high = quantileEss(draws, 0.95);
  return anyNan(low, high) ? not_defined : std::min(low, high);
}

double
mcseMean(const MatrixXd& draws)
{
  if (isDegenerate(draws))
    return not_defined;
  return std::sqrt(variance(flatten(draws)) / effectiveSampleSize(splitChains(draws)));
}

double
quantile(const VectorXd& values, double probability)
{
  if (values.size() == 0 || !values.allFinite() ||
      !(probability >= 0.0 && probability <= 1.0))
    return not_defined;
  std::vector<double> sorted(values.data(), values.data() + values.size());
  // Counted from 1 as in R: counted from 0, the last bit of the weight would differ.
  const double index = 1.0 + static_cast<double>(values.size() - 1) * probability;
  const double whole = std::floor(index);
  const double weight = index - whole;
  const auto low = sorted.begin() + static_cast<std::ptrdiff_t>(whole) - 1;
  std::nth_element(sorted.begin(), low, sorted.end());
  const auto high = std::min_element(low + 1, sorted.end());
  if (weight == 0.0 || high == sorted.end() || *high == *low)
    return *low;
  return (1.0 - weight) * *low + weight * *high;
}

} // namespace bayesian_icp
