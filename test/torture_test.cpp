// pcl::BayesianIterativeClosestPoint where it hurts: each case ends in the right
// answer, or in a status that says why not. The cases are in torture_cases.cpp; their
// table in docs/reliability.md is made here (with BAYESIAN_ICP_WRITE_TABLE set,
// written).
#include "registration_support.h"
#include "torture_cases.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace bayesian_icp {
namespace test {

void
PrintTo(const TortureCase& the_case, std::ostream* stream)
{
  *stream << the_case.id;
}

namespace {

/** chi^2 with 6 degrees of freedom exceeds it once in 10 000. */
constexpr double max_squared_distance = 27.9;

pcl::PointCloud<pcl::PointXYZ>::Ptr
cloudOf(const Eigen::Matrix3Xd& points)
{
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const auto& point : points.cast<float>().colwise())
    cloud->push_back({point.x(), point.y(), point.z()});
  cloud->is_dense = points.allFinite();
  return cloud;
}

template <typename Scalar>
PosteriorEstimate
estimateOf(const TorturePair& pair, const Options& options)
{
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, Scalar> icp;
  icp.setOptions(options);
  if (options.exact.residual.max_distance < 1.0)
    icp.setMaxCorrespondenceDistance(options.exact.residual.max_distance);
  icp.setInputSource(cloudOf(pair.source));
  icp.setInputTarget(cloudOf(pair.target));
  const pcl::test::QuietConsole quiet;
  pcl::PointCloud<pcl::PointXYZ> output;
  icp.align(output, matrixOf(pair.guess).template cast<Scalar>());
  PosteriorEstimate estimate;
  estimate.summary = icp.getSummary();
  estimate.samples = icp.getSamples();
  return estimate;
}

/** Squared distance of the truth from the mean, in standard deviations. */
double
squaredDistance(const TorturePair& pair, const Summary& summary)
{
  const auto convention = CovarianceConvention::R3xSO3;
  const Vector6d error = poseError(pair.truth, summary.mean, convention);
  return error.dot(summary.covariance(convention).ldlt().solve(error));
}

void
expectNothing(const PosteriorEstimate& estimate)
{
  EXPECT_EQ(estimate.samples.rows(), 0);
  EXPECT_TRUE(estimate.summary.mean.array().isNaN().all());
  for (const Matrix6d& covariance : estimate.summary.covariances)
    EXPECT_TRUE(covariance.array().isNaN().all());
}

void
expectVerdict(const Expectation& expected,
              const TorturePair& pair,
              const PosteriorEstimate& estimate)
{
  const Summary& summary = estimate.summary;
  const bool is_ok = summary.status == Status::Ok;
  const bool is_refused = summary.status == Status::TooFewCorrespondences ||
                          summary.status == Status::InvalidInput ||
                          summary.status == Status::InvalidOptions;
  EXPECT_EQ(is_ok, expected.verdict == Verdict::Right);
  EXPECT_EQ(is_refused, expected.verdict == Verdict::Refused);
  EXPECT_NE(summary.message.find(expected.reason), std::string::npos);
  EXPECT_TRUE(estimate.samples.allFinite());
  if (is_refused || estimate.samples.rows() == 0)
    expectNothing(estimate);
  const bool must_be_right = is_ok || expected.verdict == Verdict::RightButWarned;
  if (must_be_right) {
    ASSERT_TRUE(pair.has_truth);
    EXPECT_LT(squaredDistance(pair, summary), max_squared_distance);
  }
}

class Torture : public ::testing::TestWithParam<TortureCase> {
protected:
  template <typename Scalar>
  void
  check(std::size_t preset) const
  {
    const TortureCase& the_case = GetParam();
    const TorturePair pair = the_case.make();
    Options options = tortureOptions(torture_presets[preset]);
    the_case.change(options);
    const PosteriorEstimate estimate = estimateOf<Scalar>(pair, options);
    SCOPED_TRACE(
        the_case.id + ", " + toString(options.preset) + ": " +
        toString(estimate.summary.status) + ": " + estimate.summary.message +
        (pair.has_truth && estimate.samples.rows() > 1
             ? ", d2 " + std::to_string(squaredDistance(pair, estimate.summary))
             : ""));
    RecordProperty("message", estimate.summary.message); // for --gtest_output=xml
    expectVerdict(the_case.expected[preset], pair, estimate);
  }
};

TEST_P(Torture, Calibrated) { check<float>(0); }

TEST_P(Torture, CalibratedDouble) { check<double>(0); }

TEST_P(Torture, Exact) { check<float>(1); }

TEST_P(Torture, Paper) { check<float>(2); }

INSTANTIATE_TEST_SUITE_P(OfClouds,
                         Torture,
                         ::testing::ValuesIn(tortureCases()),
                         [](const auto& of_case) { return of_case.param.id; });

TEST(TorturePlane, ThreeOfSixMotionsAreThePriorsAlone)
{
  const PosteriorEstimate estimate = estimateOf<float>(
      flattenedPair(2, usual_noise), tortureOptions(Preset::Calibrated));
  const auto& directions = estimate.summary.data.directions;
  ASSERT_EQ(directions.size(), 6u);
  EXPECT_EQ(std::count_if(directions.begin(),
                          directions.end(),
                          [](const DataDirection& direction) {
                            return direction.observability == Observability::PriorOnly;
                          }),
            3);
}

std::string
cellOf(const Expectation& expected)
{
  const std::string reason =
      expected.reason.empty() ? "" : ": \"" + expected.reason + "\"";
  switch (expected.verdict) {
  case Verdict::Right:
    return "right";
  case Verdict::Warned:
    return "warns" + reason;
  case Verdict::RightButWarned:
    return "right, warns" + reason;
  case Verdict::Refused:
    return "refuses" + reason;
  }
  return "";
}

std::string
tableOfCases()
{
  std::string table =
      "| case | `calibrated` | `exact` | `paper` |\n|---|---|---|---|\n";
  for (const TortureCase& the_case : tortureCases()) {
    table += "| " + the_case.description;
    for (const Expectation& expected : the_case.expected)
      table += " | " + cellOf(expected);
    table += " |\n";
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
} // namespace test
} // namespace bayesian_icp
