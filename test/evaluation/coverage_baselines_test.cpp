// The baselines of the coverage study, on scans of a wavy surface.
#include "coverage/coverage_methods.h"
#include "geometry/twist.h"
#include "methods/baseline_problem.h"
#include "methods/pcl_baselines.h"
#include "study/named.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <map>

namespace bayesian_icp::evaluate {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double noise = 1e-3;
/** Distance of neighbours among the target's 4000 points in 0.5 m x 0.5 m. */
constexpr double spacing = 8e-3;

/** Points of a surface that holds all six motions, 0.5 m wide. */
Matrix3Xd
scanOfWaves(Random& random, Index count)
{
  Matrix3Xd points(3, count);
  for (Index i = 0; i < count; ++i) {
    const double x = 0.5 * random.uniform() - 0.25, y = 0.5 * random.uniform() - 0.25;
    points.col(i) << x, y, 0.05 * std::sin(12.0 * x) + 0.05 * std::cos(15.0 * y + x);
    points(2, i) += noise * random.normal();
  }
  return points;
}

/** A registration whose truth is drawn from the prior. */
CoverageCase
waves(std::uint64_t seed, Index num_source = 1000)
{
  Random random(seed, 0);
  CoverageCase c;
  c.seed = seed;
  c.target = scanOfWaves(random, 4000);
  const Matrix3Xd seen = scanOfWaves(random, num_source);
  c.prior_sd << 0.01, 0.01, 0.01, 0.03, 0.03, 0.03;
  const Vector6d deviation = c.prior_sd.cwiseProduct(random.normal6());
  // The prior is about the source's centroid, which R moves by t + R c - c.
  c.truth = isometryOf(deviation);
  const Vector3d centroid = seen.rowwise().mean();
  const Vector3d source_centroid = centroid - deviation.head<3>();
  c.truth.translation() = centroid - c.truth.linear() * source_centroid;
  c.source = c.truth.inverse() * seen;
  return c;
}

MethodResult
run(const std::string& name, const CoverageCase& c)
{
  const std::vector<CoverageMethod> methods = baselineMethods();
  return findNamed(methods, name)->run(c);
}

/** Squared error in units of the covariance. */
double
squaredError(const MethodResult& result, const CoverageCase& c)
{
  const Vector6d error = twistBetween(result.mean, c.truth, result.centre);
  return error.dot(result.covariance.ldlt().solve(error));
}

class Baseline : public ::testing::TestWithParam<std::string> {};

TEST_P(Baseline, FindsTheScanNearTheTruthWithAProperCovariance)
{
  for (const std::uint64_t seed : {1, 2, 3}) {
    const CoverageCase c = waves(seed);
    const MethodResult result = run(GetParam(), c);
    ASSERT_TRUE(result.is_valid) << result.notes;
    if (!result.is_pose_only) {
      EXPECT_EQ(result.covariance, result.covariance.transpose());
      const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(result.covariance);
      EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
    }
    const Vector3d centroid = c.source.rowwise().mean();
    // Nearest points are half a spacing away, in directions that average out; what the
    // method does not claim to know stays with the prior.
    const double sd = std::sqrt(result.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LT((result.mean * centroid - c.truth * centroid).norm(),
              0.5 * spacing + 3.0 * sd);
    EXPECT_LT(sd, 1.001 * c.prior_sd.head<3>().norm());
  }
}

TEST_P(Baseline, IsTheSameAgainAndFarFromTheOrigin)
{
  const CoverageCase c = waves(4);
  const MethodResult result = run(GetParam(), c);
  const MethodResult again = run(GetParam(), c);
  EXPECT_EQ(result.mean.matrix(), again.mean.matrix());
  EXPECT_EQ(result.covariance, again.covariance);

  const Vector3d far(4e5, 5.4e6, 120.0);
  CoverageCase moved = c;
  moved.target.colwise() += far;
  moved.truth = Eigen::Translation3d(far) * c.truth;
  moved.prior_mean.head<3>() += far;
  const MethodResult there = run(GetParam(), moved);
  ASSERT_TRUE(there.is_valid);
  // Floats resolve 0.5 m there. Relative to a point of the cloud they resolve 3e-8 m,
  // which swaps a few neighbours that are equally far; point-to-point ICP without a
  // prior has a minimum for every few of them, and so have secants.
  const bool is_smooth = GetParam() == "naive" || GetParam() == "closed-form";
  const Vector3d centroid = c.source.rowwise().mean();
  EXPECT_LT((there.mean * centroid - far - result.mean * centroid).norm(),
            is_smooth ? 1e-5 : 0.5 * spacing);
  if (is_smooth) {
    EXPECT_LT((there.covariance - result.covariance).norm(),
              0.01 * result.covariance.norm());
  }
}

TEST_P(Baseline, RefusesEmptyClouds)
{
  CoverageCase c = waves(5);
  c.source.resize(3, 0);
  const MethodResult result = run(GetParam(), c);
  EXPECT_FALSE(result.is_valid);
  EXPECT_EQ(result.notes, "empty cloud");
}

INSTANTIATE_TEST_SUITE_P(
    All, Baseline, ::testing::ValuesIn(namesOf(baselineMethods())), [](const auto& i) {
      std::string name = i.param;
      name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
      return name;
    });

/** Here the closed form's assumptions hold: noise that is independent, of points on a
 * smooth surface all of which is seen. Those of the naive covariance never do: most of
 * a nearest point's distance is spacing, not noise. */
TEST(Baselines, ClosedFormIsCalibratedOnAnIdealSurfaceAndNaiveIsNot)
{
  constexpr int num_runs = 20;
  std::map<std::string, double> mean;
  for (int k = 0; k < num_runs; ++k) {
    const CoverageCase c = waves(100 + static_cast<std::uint64_t>(k));
    for (const char* name : {"naive", "closed-form", "point-to-point-sandwich"})
      mean[name] += squaredError(run(name, c), c) / (6.0 * num_runs);
  }
  // A chi-square variate of 6 * 20 degrees of freedom over its mean, 4 sd.
  const double tolerance = 4.0 * std::sqrt(2.0 / (6.0 * num_runs));
  EXPECT_NEAR(mean["closed-form"], 1.0, tolerance);
  EXPECT_LT(mean["point-to-point-sandwich"], 1.0 + tolerance);
  EXPECT_GT(mean["naive"], 1.0 + 3.0 * tolerance);
}

TEST(BaselineProblem, CombinesInformationAsGaussiansDo)
{
  const CoverageCase c = waves(6);
  const BaselineProblem problem(c);
  const Isometry3d mean = problem.priorMean();
  const TwistPrior prior = twistPrior(problem.prior, mean, problem.centreAt(mean));
  const MethodResult alone = problem.combineWithPrior(mean, {});
  EXPECT_LT((alone.mean.matrix() - mean.matrix()).norm(), 1e-12);
  EXPECT_LT((alone.covariance * prior.precision - Matrix6d::Identity()).norm(), 1e-9);

  // As much information as the prior's, about a place 1 mm off: half way there.
  const Vector6d offset = 1e-3 * Vector6d::Ones();
  GaussianInformation same;
  same.information = prior.precision;
  same.gradient = -prior.precision * offset;
  const MethodResult both = problem.combineWithPrior(mean, same);
  EXPECT_LT((twistBetween(mean, both.mean, both.centre) - 0.5 * offset).norm(), 1e-12);
  EXPECT_LT((both.covariance - 0.5 * alone.covariance).norm(), 1e-12);
}

TEST(BaselineProblem, RegistersAtMostItsShareOfTheSource)
{
  const CoverageCase c = waves(7, 5000);
  const BaselineProblem problem(c);
  ASSERT_EQ(problem.source.cols(), max_source_points);
  std::vector<Eigen::Index> columns = problem.source_columns;
  std::sort(columns.begin(), columns.end());
  EXPECT_TRUE(std::adjacent_find(columns.begin(), columns.end()) == columns.end());
  // The mean of 2000 of 5000 indices, uniform: sd 5000 sqrt(0.6 / (12 * 2000)) = 25.
  double mean = 0.0;
  for (const Eigen::Index column : columns)
    mean += static_cast<double>(column) / max_source_points;
  EXPECT_NEAR(mean, 2499.5, 4.0 * 25.0);
  EXPECT_LT((problem.prior.referencePoint() - c.source.rowwise().mean()).norm(), 1e-12);
}

TEST(BaselineProblem, NaiveFitIsAMinimumForItsMatches)
{
  const CoverageCase c = waves(8);
  const BaselineProblem problem(c);
  const IcpFit fit = fitNaively(problem);
  const Vector3d centre = problem.centreAt(fit.pose);
  const GaussNewton sums = gaussNewton(fit.matches, centre);
  const MethodResult result = problem.combineWithPrior(
      fit.pose, {sums.hessian / fit.variance, sums.gradient / fit.variance});
  // The fit's last weight was another one, by a step of ICP.
  EXPECT_LT(twistBetween(fit.pose, result.mean, centre).norm(), 1e-5);
  EXPECT_GT(result.num_queries, 2 * problem.source.cols());
}

TEST(PclBaselines, FindTheExactPoseOfACopy)
{
  Random random(9, 0);
  const Matrix3Xd target = scanOfWaves(random, 800);
  Vector6d pose;
  pose << 0.3, -0.2, 0.1, 0.02, -0.01, 0.03;
  const Isometry3d truth = isometryOf(pose);
  const Matrix3Xd source = truth.inverse() * target;
  std::vector<Eigen::Index> columns;
  for (Eigen::Index i = 0; i < 800; i += 2)
    columns.push_back(i);
  const Isometry3d guess =
      movedBy(2e-3 * Vector6d::Ones(), target.rowwise().mean(), truth);
  const PclProblem problem{source, target, columns, guess};
  const PclFit icp = fitPclIcp(problem);
  EXPECT_TRUE(icp.has_converged);
  // Floats of 0.3 m resolve 3e-8 m.
  EXPECT_LT((icp.pose.matrix() - truth.matrix()).norm(), 1e-5);
  const GicpFit gicp = fitPclGicp(problem);
  EXPECT_TRUE(gicp.fit.has_converged);
  EXPECT_LT((gicp.fit.pose.matrix() - truth.matrix()).norm(), 1e-4);
  // A point and its copy have the same plane: 1 along, 0.001 across, twice.
  ASSERT_EQ(gicp.covariances.size(), columns.size());
  for (const Eigen::Matrix3d& C : gicp.covariances) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(C);
    EXPECT_LT((solver.eigenvalues() - Vector3d(0.002, 2.0, 2.0)).norm(), 0.01);
  }
}

TEST(PclBaselines, RefuseTooFewPoints)
{
  Random random(10, 0);
  const Matrix3Xd few = scanOfWaves(random, 10);
  const GicpFit gicp = fitPclGicp({few, few, {0, 1, 2}, Isometry3d::Identity()});
  EXPECT_FALSE(gicp.fit.has_converged);
  EXPECT_EQ(gicp.moved.cols(), 0);
}

} // namespace
} // namespace bayesian_icp::evaluate
