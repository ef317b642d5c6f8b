// ICP from random starts: reproducible, divisible, the one of PCL.
#include "geometry/twist.h"
#include "paper/monte_carlo_icp.h"
#include "support/test_support.h"

#include <pcl/registration/icp.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bayesian_icp::evaluate {
namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr
cloudOf(const Eigen::Matrix3Xd& points)
{
  const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const auto& point : points.cast<float>().colwise())
    cloud->push_back({point.x(), point.y(), point.z()});
  return cloud;
}

class MonteCarloIcp : public testing::Test {
protected:
  MonteCarloIcp()
  {
    Random random(8, 0);
    target_ = test::randomPoints(random, 300);
    source_ = target_.leftCols(120);
    options_.num_runs = 24;
    options_.half_range.setConstant(0.3);
  }

  std::vector<MonteCarloIcpRun>
  run(const MonteCarloIcpOptions& options) const
  {
    return monteCarloIcp(source_, target_, options);
  }

  static void
  expectSame(const MonteCarloIcpRun& a, const MonteCarloIcpRun& b)
  {
    EXPECT_EQ(a.index, b.index);
    EXPECT_EQ(a.start, b.start);
    EXPECT_EQ(a.end, b.end);
    EXPECT_EQ(a.stop, b.stop);
    EXPECT_EQ(a.has_converged, b.has_converged);
    EXPECT_EQ(a.num_iterations, b.num_iterations);
    EXPECT_EQ(a.mean_squared_distance, b.mean_squared_distance);
  }

  Eigen::Matrix3Xd target_, source_;
  MonteCarloIcpOptions options_;
};

} // namespace

TEST_F(MonteCarloIcp, APartIsAPartOfTheWhole)
{
  const auto whole = run(options_);
  options_.first_run = 7;
  options_.num_runs = 5;
  const auto part = run(options_);
  ASSERT_EQ(part.size(), 5u);
  for (std::size_t i = 0; i < part.size(); ++i)
    expectSame(part[i], whole[i + 7]);
}

TEST_F(MonteCarloIcp, RunsHaveAnIndexThatAnIntCanHold)
{
  options_.first_run = std::numeric_limits<int>::max() - 2;
  const auto runs = run(options_);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[1].index, std::numeric_limits<int>::max() - 1);
}

TEST_F(MonteCarloIcp, APointBeyondFloatHasNoNeighbourAndDoesNoHarm)
{
  source_(0, 0) = std::numeric_limits<double>::max();
  for (const MonteCarloIcpRun& made : run(options_)) {
    EXPECT_TRUE(made.has_converged);
    EXPECT_TRUE(made.end.allFinite());
  }
}

TEST_F(MonteCarloIcp, NumberOfThreadsChangesNoBit)
{
  options_.num_threads = 1;
  const auto alone = run(options_);
  for (const int num_threads : {2, 3, 8}) {
    options_.num_threads = num_threads;
    const auto together = run(options_);
    ASSERT_EQ(together.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i)
      expectSame(together[i], alone[i]);
  }
}

TEST_F(MonteCarloIcp, RunsArePclsIcpFromTheirStarts)
{
  options_.max_distance = 0.2;
  for (const MonteCarloIcpRun& made : run(options_)) {
    pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double> icp;
    icp.setInputSource(cloudOf(source_));
    icp.setInputTarget(cloudOf(target_));
    icp.setMaxCorrespondenceDistance(options_.max_distance);
    icp.setMaximumIterations(options_.max_iterations);
    pcl::PointCloud<pcl::PointXYZ> moved;
    icp.align(moved, matrixOf(made.start));
    EXPECT_EQ(made.end, poseOf(icp.getFinalTransformation()));
    EXPECT_EQ(made.has_converged, icp.hasConverged());
  }
}

TEST_F(MonteCarloIcp, RunsTellWhatEndedThem)
{
  options_.num_runs = 1;
  const MonteCarloIcpRun complete = run(options_).front();
  EXPECT_EQ(complete.stop, IcpStop::AbsoluteFitness);
  EXPECT_TRUE(complete.has_converged);
  EXPECT_GT(complete.num_iterations, 1);

  options_.max_iterations = 0;
  const MonteCarloIcpRun one = run(options_).front();
  EXPECT_EQ(one.stop, IcpStop::MaxIterations);
  EXPECT_TRUE(one.has_converged);
  EXPECT_EQ(one.num_iterations, 1);
  double sum = 0.0;
  for (const auto& point : source_.colwise())
    sum += (target_.colwise() - isometryOf(one.start) * Eigen::Vector3d(point))
               .colwise()
               .squaredNorm()
               .minCoeff();
  EXPECT_NEAR(one.mean_squared_distance, sum / 120.0, 1e-6);

  options_.max_distance = 1e-6;
  options_.mean.setConstant(0.1);
  const MonteCarloIcpRun lost = run(options_).front();
  EXPECT_EQ(lost.stop, IcpStop::TooFewPairs);
  EXPECT_FALSE(lost.has_converged);
  EXPECT_EQ(lost.num_iterations, 0);
  EXPECT_EQ(lost.end, poseOf(matrixOf(lost.start)));
  EXPECT_TRUE(std::isinf(lost.mean_squared_distance));
}

TEST_F(MonteCarloIcp, StartsAreUniformInTheirRange)
{
  options_.num_runs = 600;
  options_.max_iterations = 1;
  options_.mean << 1.0, -2.0, 3.0, 0.1, -0.2, 0.3;
  options_.half_range << 1.0, 0.5, 0.25, 0.3, 0.2, 0.1;
  const auto runs = run(options_);
  for (int k = 0; k < 6; ++k) {
    double sum = 0.0, sum_of_squares = 0.0;
    for (const MonteCarloIcpRun& made : runs) {
      const double u = (made.start[k] - options_.mean[k]) / options_.half_range[k];
      EXPECT_LE(std::abs(u), 1.0);
      sum += u / 600.0;
      sum_of_squares += u * u / 600.0;
    }
    // Variance 1/3, of the square 1/5 - 1/9; five standard errors.
    EXPECT_NEAR(sum, 0.0, 5.0 * std::sqrt(1.0 / 3.0 / 600.0)) << k;
    EXPECT_NEAR(sum_of_squares, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / 600.0)) << k;
  }
  options_.seed = 2;
  EXPECT_NE(run(options_).front().start, runs.front().start);
}

TEST_F(MonteCarloIcp, MakesNoRunWhereNoneIsAskedFor)
{
  options_.num_runs = 0;
  EXPECT_TRUE(run(options_).empty());
}

} // namespace bayesian_icp::evaluate
