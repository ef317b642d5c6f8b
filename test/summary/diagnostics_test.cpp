/** \file
 * \brief The convergence diagnostics against R's package posterior (stored values, see
 * data/diagnostics/make_reference.R) and against the theory of AR(1) chains.
 */
#include <bayesian_icp/diagnostics.h>

#include <gtest/gtest.h>

#include <unsupported/Eigen/SpecialFunctions>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using bayesian_icp::bulkEss;
using bayesian_icp::mcseMean;
using bayesian_icp::quantile;
using bayesian_icp::rhat;
using bayesian_icp::tailEss;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/** \brief Both sides work in double on at most 2000 draws: some thousand roundings of
 * 1e-16 each, and up to three digits lost in the differences of chain means. */
constexpr double tolerance = 1e-10;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

using Rows = std::vector<std::vector<std::string>>;

/** \brief The cells of a file in data/diagnostics, without the heading. */
Rows
readCsv(const std::string& name)
{
  std::ifstream file(BAYESIAN_ICP_TEST_DATA_DIR "/diagnostics/" + name + ".csv");
  std::string line;
  if (!std::getline(file, line))
    throw std::runtime_error("no test data " + name);
  Rows rows;
  while (std::getline(file, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      rows.back().push_back(cell);
  }
  return rows;
}

double
number(const std::string& cell)
{
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0')
    throw std::runtime_error("not a number: " + cell);
  return value;
}

MatrixXd
readChains(const std::string& name)
{
  const Rows rows = readCsv(name);
  MatrixXd draws(rows.size(), rows.at(0).size());
  for (Index draw = 0; draw < draws.rows(); ++draw)
    for (Index chain = 0; chain < draws.cols(); ++chain)
      draws(draw, chain) = number(rows[draw].at(chain));
  return draws;
}

/** \brief Equal up to the tolerance; NaN and infinity equal themselves only. */
void
expectSame(double actual, double expected)
{
  if (std::isfinite(expected))
    EXPECT_NEAR(actual, expected, tolerance * std::abs(expected));
  else if (std::isnan(expected))
    EXPECT_TRUE(std::isnan(actual)) << actual;
  else
    EXPECT_EQ(actual, expected);
}

void
expectAllNan(const MatrixXd& draws)
{
  EXPECT_TRUE(std::isnan(rhat(draws)));
  EXPECT_TRUE(std::isnan(bulkEss(draws)));
  EXPECT_TRUE(std::isnan(tailEss(draws)));
  EXPECT_TRUE(std::isnan(mcseMean(draws)));
}

/** \brief Stationary Gaussian AR(1) chains with mean 0 and variance 1. */
MatrixXd
autoregressiveChains(Index draws, Index chains, double rho, unsigned seed)
{
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  MatrixXd x(draws, chains);
  for (Index chain = 0; chain < chains; ++chain) {
    x(0, chain) = normal(generator);
    for (Index draw = 1; draw < draws; ++draw)
      x(draw, chain) =
          rho * x(draw - 1, chain) + std::sqrt(1.0 - rho * rho) * normal(generator);
  }
  return x;
}

TEST(Diagnostics, EqualThoseOfPosterior140)
{
  const Rows versions = readCsv("versions");
  EXPECT_EQ(versions.at(1), (std::vector<std::string>{"posterior", "1.4.0"}));
  const Rows references = readCsv("reference");
  ASSERT_GE(references.size(), 20u);
  for (const auto& reference : references) {
    SCOPED_TRACE(reference.at(0));
    const MatrixXd draws = readChains(reference[0]);
    expectSame(rhat(draws), number(reference.at(1)));
    expectSame(bulkEss(draws), number(reference.at(2)));
    expectSame(tailEss(draws), number(reference.at(3)));
    expectSame(mcseMean(draws), number(reference.at(4)));
  }
}

TEST(Diagnostics, AreNanForDrawsThatAreNotFiniteOrConstantOrTooFew)
{
  const MatrixXd infinite = readChains("one_infinite");
  ASSERT_EQ((infinite.array() == inf).count(), 1);
  expectAllNan(infinite);
  expectAllNan(-infinite);
  expectAllNan(readChains("one_nan"));
  expectAllNan(MatrixXd::Zero(100, 4));
  expectAllNan(MatrixXd::Constant(101, 3, 0.1));
  const MatrixXd draws = readChains("iid_normal");
  for (Index count = 0; count < 4; ++count)
    expectAllNan(draws.topRows(count));
  expectAllNan(MatrixXd(10, 0));
}

TEST(Diagnostics, ShortestDefinedInputIsFourDrawsForRhatAndSixForTheOthers)
{
  const MatrixXd draws = readChains("iid_normal");
  EXPECT_TRUE(std::isfinite(rhat(draws.topRows(4))));
  EXPECT_TRUE(std::isnan(bulkEss(draws.topRows(5))));
  EXPECT_TRUE(std::isnan(tailEss(draws.topRows(5))));
  EXPECT_TRUE(std::isnan(mcseMean(draws.topRows(5))));
  EXPECT_TRUE(std::isfinite(bulkEss(draws.topRows(6))));
  EXPECT_TRUE(std::isfinite(tailEss(draws.topRows(6))));
  EXPECT_TRUE(std::isfinite(mcseMean(draws.topRows(6))));
}

TEST(Diagnostics, RhatIsInfiniteForChainsThatNeverMoveButDiffer)
{
  for (Index length = 4; length < 200; ++length) {
    MatrixXd draws(length, 3);
    draws.rowwise() = Eigen::RowVector3d(0.1, 0.2, 0.7);
    EXPECT_EQ(rhat(draws), inf) << length;
  }
}

TEST(Diagnostics, RankBasedOnesAreFiniteNearTheLargestDouble)
{
  MatrixXd draws = readChains("iid_normal").topRows(50);
  const double expected_ess = bulkEss(draws);
  draws *= 0.25 * std::numeric_limits<double>::max() / draws.cwiseAbs().maxCoeff();
  expectSame(bulkEss(draws), expected_ess);
  EXPECT_TRUE(std::isfinite(rhat(draws)));
  EXPECT_TRUE(std::isfinite(tailEss(draws)));
  EXPECT_FALSE(std::isfinite(mcseMean(draws))); // the variance overflows
}

/** The relative variance of an autocorrelation time, summed up to lag W over N draws,
 * is 2 (2 W + 1) / N (Madras, Sokal: The pivot algorithm, J. Stat. Phys. 50, 1988).
 * Geyer's sequence ends at the first negative pair: the autocorrelation 0.5^t sinks
 * below its own noise, sqrt(5/3 / N) = 0.0014 here, at lag 9.5; W = 25 leaves seven
 * pairs of pure noise, which have a probability of about 2^-7 to be all positive.
 * Tolerance: five sigma. */
TEST(Diagnostics, EssOfLongAutoregressiveChainsFollowsTheory)
{
  const Index length = 200000;
  const double rho = 0.5;
  const MatrixXd draws = autoregressiveChains(length, 4, rho, 7);
  const double size = static_cast<double>(draws.size());
  const double theory = size * (1.0 - rho) / (1.0 + rho);
  const double relative_sigma = std::sqrt(2.0 * (2.0 * 25.0 + 1.0) / size);
  EXPECT_NEAR(bulkEss(draws) / theory, 1.0, 5.0 * relative_sigma);
  // Half the relative error by the square root; that of the variance, about
  // sqrt(5/3 / (2 N)), is ten times smaller.
  EXPECT_NEAR(mcseMean(draws) * std::sqrt(theory), 1.0, 3.0 * relative_sigma);
  // Split R-hat of 2 m chains: its square is 1 + (F - 1) / n with F = tau F', F' of
  // 2 m - 1 = 7 degrees of freedom, below 5 but for a probability of 1e-5.
  const double tau = (1.0 + rho) / (1.0 - rho);
  EXPECT_LT(rhat(draws), std::sqrt(1.0 + 5.0 * tau / (0.5 * length)));
}

TEST(Diagnostics, DoNotDependOnTheOrderOfChainsNorOnTheUnit)
{
  const MatrixXd draws = readChains("different_means");
  const MatrixXd other = -8.0 * draws.rowwise().reverse();
  expectSame(rhat(other), rhat(draws));
  expectSame(bulkEss(other), bulkEss(draws));
  expectSame(tailEss(other), tailEss(draws));
  expectSame(mcseMean(other), 8.0 * mcseMean(draws));
}

TEST(Quantile, EqualsTypeSevenOfR)
{
  const Rows references = readCsv("quantiles");
  ASSERT_GE(references.size(), 50u);
  for (const auto& reference : references) {
    SCOPED_TRACE(reference.at(0) + " at " + reference.at(1));
    const VectorXd values = readChains(reference[0]).reshaped();
    // Bit by bit: the tail ESS counts the draws up to a quantile that is one of them.
    EXPECT_EQ(quantile(values, number(reference[1])), number(reference.at(2)));
  }
  for (const double probability : {0.0, 0.3, 1.0}) // of one value
    EXPECT_EQ(quantile(VectorXd::Constant(1, 2.5), probability), 2.5);
}

TEST(Quantile, IsNanForNoValueABadValueOrABadProbability)
{
  const VectorXd values = VectorXd::LinSpaced(5, 0.0, 1.0);
  EXPECT_TRUE(std::isnan(quantile(VectorXd(), 0.5)));
  EXPECT_TRUE(std::isnan(quantile(values, -0.1)));
  EXPECT_TRUE(std::isnan(quantile(values, 1.1)));
  EXPECT_TRUE(std::isnan(quantile(values, nan)));
  EXPECT_TRUE(std::isnan(quantile((VectorXd(2) << 1.0, nan).finished(), 0.0)));
  EXPECT_TRUE(std::isnan(quantile((VectorXd(2) << 1.0, inf).finished(), 0.0)));
}

/** Eigen's inverse normal distribution function makes the normal scores. Here it is
 * undone by std::erfc, for all probabilities that ranks of 25 000 draws give. An error
 * e of a score x becomes x^2 e in the tail: 16 times 1e-15. */
TEST(NormalScores, InverseNormalInvertsTheNormalDistribution)
{
  const int size = 25000;
  for (int rank = 1; rank <= size; ++rank) {
    const double probability = (rank - 0.375) / (size + 0.25);
    const double score = Eigen::numext::ndtri(probability);
    const double back = 0.5 * std::erfc(-score / std::sqrt(2.0));
    EXPECT_NEAR(back, probability, 2e-14 * probability);
  }
}

} // namespace
