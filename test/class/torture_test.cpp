// pcl::BayesianIterativeClosestPoint where it hurts: each case ends in the right
// answer, or in a status that says why not. The cases are in torture_cases.cpp; their
// table in docs/reliability.md is made here (with BAYESIAN_ICP_WRITE_TABLE set,
// written).
#include "class/torture_cases.h"
#include "sampler/chain_set.h"
#include "search/finite_columns.h"
#include "summary/estimates.h"
#include "support/registration_support.h"
#include "support/test_support.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace bayesian_icp::test {

void
PrintTo(const TortureCase& the_case, std::ostream* stream)
{
  *stream << the_case.id;
}

namespace {

/** In standard deviations of the noise: a third of the way from the guess to the truth
 * of most pairs. */
constexpr double max_error = 3.0;

/** Of the mean pose, in standard deviations of the draws. */
constexpr double max_offset = 0.1;

template <typename Scalar>
PosteriorEstimate
estimateOf(const TorturePair& pair, const Options& options)
{
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, Scalar> icp;
  icp.setOptions(options);
  if (options.exact.residual.max_distance < 1.0)
    icp.setMaxCorrespondenceDistance(options.exact.residual.max_distance);
  const pcl::test::QuietConsole quiet;
  pcl::test::aligned(icp,
                     pcl::test::cloudOf(pair.source),
                     pcl::test::cloudOf(pair.target),
                     matrixOf(pair.guess).template cast<Scalar>());
  PosteriorEstimate estimate;
  estimate.summary = icp.getSummary();
  estimate.samples = icp.getSamples();
  return estimate;
}

/** Where the draws put a point of the source, along the axes that the clouds hold: root
 * mean squares over all points [m]. */
struct Placement {
  /** From its place at the truth to the mean of its places. */
  double error;
  /** Standard deviation about that mean. */
  double spread;
  /** From the mean of its places to its place at the mean pose. */
  double offset_of_mean;
};

Placement
placementOf(const TorturePair& pair, const Vector6d& mean, const PoseMatrix& draws)
{
  const int num_held_axes = 3 - pair.num_free_axes;
  const Eigen::Matrix3d to_source = rotationOf(pair.truth).transpose();
  const Eigen::Matrix3Xd source = pair.source(Eigen::all, finiteColumns(pair.source));
  const Eigen::Matrix3Xd truth = moved(pair.truth, source);
  const auto offsetsOf = [&](const Vector6d& pose) -> Eigen::MatrixXd {
    return (to_source * (moved(pose, source) - truth)).bottomRows(num_held_axes);
  };
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(num_held_axes, source.cols());
  double sum_of_squares = 0.0;
  for (const auto& draw : draws.rowwise()) {
    const Eigen::MatrixXd offsets = offsetsOf(draw.transpose());
    sum += offsets;
    sum_of_squares += offsets.squaredNorm();
  }
  const auto num_draws = static_cast<double>(draws.rows());
  const auto num_points = static_cast<double>(source.cols());
  const double squared_error = (sum / num_draws).squaredNorm() / num_points;
  return {std::sqrt(squared_error),
          std::sqrt(sum_of_squares / (num_draws * num_points) - squared_error),
          (offsetsOf(mean) - sum / num_draws).norm() / std::sqrt(num_points)};
}

/** Whether a posterior holds the truth and says more than a single point would. */
::testing::AssertionResult
isRight(const TorturePair& pair,
        const Options& options,
        const PosteriorEstimate& estimate)
{
  // Preset calibrated is told no scale: it has to find the noise.
  const double sd_of_a_point = options.preset == Preset::Calibrated ? pair.noise
                               : options.preset == Preset::Exact
                                   ? options.exact.scale.measurement_sigma
                                   : options.paper.scale.measurement_sigma;
  const double squared_error = squaredErrorOf(estimate.summary, pair.truth);
  const Placement placement =
      placementOf(pair, estimate.summary.mean, estimate.samples);
  const bool is_right = pair.has_truth && squared_error < chi_square_9999 &&
                        placement.error < max_error * pair.noise &&
                        placement.spread < sd_of_a_point &&
                        placement.offset_of_mean < max_offset * placement.spread;
  return (is_right ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << "squared error " << squared_error << ", error " << placement.error
         << " m, spread " << placement.spread << " m, mean " << placement.offset_of_mean
         << " m off";
}

class Torture : public ::testing::TestWithParam<TortureCase> {
protected:
  template <typename Scalar>
  void
  check(Options options, const Expectation& expected) const
  {
    if (expected.outcomes.empty())
      return;
    const TortureCase& the_case = GetParam();
    const TorturePair pair = the_case.make(options);
    const PosteriorEstimate estimate = estimateOf<Scalar>(pair, options);
    const Summary& summary = estimate.summary;
    SCOPED_TRACE(the_case.id + ", " + toString(options.preset) + ": " +
                 toString(summary.status) + ": " + summary.message);
    RecordProperty("message", summary.message); // for --gtest_output=xml
    EXPECT_TRUE(std::any_of(expected.outcomes.begin(),
                            expected.outcomes.end(),
                            [&summary](const Outcome& outcome) {
                              return summary.status == outcome.status &&
                                     summary.message.find(outcome.reason) !=
                                         std::string::npos;
                            }));
    EXPECT_TRUE(estimate.samples.allFinite());
    if (expected.verdict == Verdict::Refused || estimate.samples.rows() == 0) {
      EXPECT_EQ(estimate.samples.rows(), 0);
      EXPECT_TRUE(summary.mean.array().isNaN().all());
      for (const Matrix6d& covariance : summary.covariances)
        EXPECT_TRUE(covariance.array().isNaN().all());
    }
    if (expected.verdict == Verdict::Right ||
        expected.verdict == Verdict::RightButWarned) {
      EXPECT_TRUE(isRight(pair, options, estimate));
    }
  }
};

TEST_P(Torture, Calibrated)
{
  check<float>(tortureOptions(Preset::Calibrated), GetParam().expected[0]);
}

TEST_P(Torture, CalibratedDouble)
{
  check<double>(tortureOptions(Preset::Calibrated), GetParam().expected[0]);
}

TEST_P(Torture, Exact)
{
  check<float>(tortureOptions(Preset::Exact), GetParam().expected[1]);
}

TEST_P(Torture, Paper)
{
  check<float>(tortureOptions(Preset::Paper), GetParam().expected[2]);
}

TEST_P(Torture, PaperWithSmallSteps)
{
  check<float>(smallStepOptions(), GetParam().with_small_steps);
}

INSTANTIATE_TEST_SUITE_P(OfClouds,
                         Torture,
                         ::testing::ValuesIn(tortureCases()),
                         [](const auto& of_case) { return of_case.param.id; });

TEST(TortureRight, ThePriorAloneIsNot)
{
  for (const TortureCase& the_case : tortureCases())
    for (const Preset preset : {Preset::Calibrated, Preset::Exact}) {
      if (the_case.expected[preset == Preset::Exact].verdict != Verdict::Right)
        continue;
      Options options = tortureOptions(preset);
      const Vector6d sd = options.prior.variance.cwiseSqrt();
      const TorturePair pair = the_case.make(options);
      Random random(1, 0);
      PosteriorEstimate prior;
      prior.samples.resize(1000, 6);
      for (auto draw : prior.samples.rowwise())
        draw = (pair.guess + sd.cwiseProduct(random.normal6())).transpose();
      ChainSet chains;
      chains.chains.push_back({prior.samples, false});
      prior.summary = summarize(chains);
      EXPECT_FALSE(isRight(pair, options, prior)) << the_case.id;
    }
}

std::string
cellOf(const Expectation& expected)
{
  std::string outcomes;
  for (const Outcome& outcome : expected.outcomes)
    outcomes += (outcomes.empty() ? ": `" : " or `") +
                std::string(toString(outcome.status)) + "`, \"" + outcome.reason + "\"";
  switch (expected.verdict) {
  case Verdict::Right:
    return "right";
  case Verdict::Warned:
    return "warns" + outcomes;
  case Verdict::RightButWarned:
    return "right, warns" + outcomes;
  case Verdict::Refused:
    return "refuses" + outcomes;
  case Verdict::NoSuchOption:
    return "no such option";
  case Verdict::NotTried:
    return "";
  }
  return "";
}

std::string
tableOfCases()
{
  std::string table =
      "| case | `calibrated` | `exact` | `paper` | `paper`, small steps "
      "|\n|---|---|---|---|---|\n";
  for (const TortureCase& the_case : tortureCases()) {
    table += "| " + the_case.description;
    for (const Expectation& expected : the_case.expected)
      table += " | " + cellOf(expected);
    table += " | " + cellOf(the_case.with_small_steps) + " |\n";
  }
  return table;
}

TEST(TortureTable, IsTheOneOfTheDocumentation)
{
  const std::string begin = "<!-- table of cases: begin -->\n";
  const std::string end = "<!-- table of cases: end -->\n";
  const std::string name = BAYESIAN_ICP_RELIABILITY;
  std::ostringstream content;
  content << std::ifstream(name).rdbuf();
  std::string text = content.str();
  const std::size_t first = text.find(begin), last = text.find(end);
  ASSERT_NE(first, std::string::npos) << name;
  ASSERT_NE(last, std::string::npos) << name;
  const std::size_t place = first + begin.size();
  if (std::getenv("BAYESIAN_ICP_WRITE_TABLE") != nullptr)
    std::ofstream(name) << text.replace(place, last - place, tableOfCases());
  else
    EXPECT_EQ(text.substr(place, last - place), tableOfCases());
}

} // namespace
} // namespace bayesian_icp::test
