#include "calibrated/calibrated_estimate.h"
#include "calibrated/calibration_test_support.h"
#include "search/finite_columns.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double sigma = 0.001;

/** 0.02 m and 0.05 rad. */
Vector6d
priorDeviations()
{
  return {0.02, 0.02, 0.02, 0.05, 0.05, 0.05};
}

/** A ball beside a box, seen from everywhere. */
test::Sheet
ballAndBox(Random& random, Index num_points)
{
  const test::Sheet ball = test::sphere(random, num_points / 3, 0.06);
  const test::Sheet box =
      test::box(random, num_points - num_points / 3, {0.12, 0.09, 0.07});
  test::Sheet both(num_points);
  both.points << ball.points.colwise() + Vector3d(0.0, 0.2, 0.05), box.points;
  both.normals << ball.normals, box.normals;
  return both;
}

/** Two scans [m], and a true pose from the prior. */
struct Scans {
  explicit Scans(std::uint64_t stream,
                 Index num_source_points = 500,
                 Index num_target_points = 2000)
  {
    Random random(101, stream);
    target = test::noisy(ballAndBox(random, num_target_points), sigma, random);
    const Matrix3Xd seen =
        test::noisy(ballAndBox(random, num_source_points), sigma, random);
    truth = isometryOf(random.normal6().cwiseProduct(priorDeviations()));
    const Vector3d centre = seen.rowwise().mean();
    truth = Eigen::Translation3d(centre) * truth * Eigen::Translation3d(-centre);
    // In random order, as estimateCalibrated() wants them.
    source = truth.inverse() *
             seen(Eigen::all, randomChoice(seen.cols(), seen.cols(), random));
  }

  Matrix3Xd source, target;
  Isometry3d truth = Isometry3d::Identity();
};

/** Their registration. */
struct Case : Scans, test::Problem {
  explicit Case(const Scans& scans)
  : Scans(scans)
  , Problem(source, target, priorDeviations())
  {}

  /** Of the posterior mean, in standard deviations. */
  double
  squaredError(const CalibratedEstimate& e) const
  {
    return test::squaredError(
        twistBetween(movedBy(e.mean, e.centre, e.mode), truth, e.centre), e.covariance);
  }
};

/** Whether the sum of squared errors is among 99.9 % of those of exact posteriors. */
void
expectRight(const std::vector<double>& squared_errors)
{
  const double sum = std::accumulate(squared_errors.begin(), squared_errors.end(), 0.0);
  const boost::math::chi_squared all(6.0 * double(squared_errors.size()));
  EXPECT_GT(sum, quantile(all, 0.0005));
  EXPECT_LT(sum, quantile(all, 0.9995));
}

TEST(CalibratedEstimate, ErrorsAreAsLargeAsItSays)
{
  std::vector<double> squared_errors;
  for (std::uint64_t stream = 0; stream < 60; ++stream) {
    const Case c{Scans(stream)};
    squared_errors.push_back(c.squaredError(c.estimate()));
  }
  expectRight(squared_errors);
  // At least 53 of 60 are within, were it 95 %, with a probability of 99.6 %.
  const double most = quantile(boost::math::chi_squared(6.0), 0.95);
  EXPECT_GE(std::count_if(squared_errors.begin(),
                          squared_errors.end(),
                          [most](double e) { return e < most; }),
            53);
}

/** Expects that 40 estimates are right.
 * \param[in] estimates of a case, and with fewer points
 * \return ratio of their deviations, the geometric mean */
template <typename Estimates>
double
ratioOfDeviations(std::uint64_t first_stream,
                  Index num_target_points,
                  const Estimates& estimates)
{
  constexpr int num_cases = 40;
  double sum = 0.0;
  std::vector<double> squared_errors;
  for (std::uint64_t k = 0; k < num_cases; ++k) {
    const Case c{Scans(first_stream + k, 2000, num_target_points)};
    const auto [e, of_fewer] = estimates(c);
    squared_errors.push_back(c.squaredError(e));
    sum += std::log(e.covariance.determinant() / of_fewer.covariance.determinant());
  }
  expectRight(squared_errors);
  return std::exp(sum / (12.0 * num_cases));
}

TEST(CalibratedEstimate, MorePointsThanThoseOfTheCurvatureMakeItSharper)
{
  EstimateOptions options;
  options.num_curvature_points = 500;
  const double ratio = ratioOfDeviations(200, 8000, [&](const Case& c) {
    return std::pair(c.estimate(options),
                     estimateCalibrated(c.scorer.ofFirst(500), c.prior, options));
  });
  // Four times as many points halve the deviations, less what the target's noise adds:
  // if it counted as much as the noise of its 2000 points in the source, by (2 /
  // 5)^1/2.
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 0.7);
}

TEST(CalibratedEstimate, TheTargetsPointsMakeItSharper)
{
  const double ratio = ratioOfDeviations(400, 2000, [](const Case& c) {
    const Matrix3Xd& points = c.scorer.sourcePoints();
    const PreparedSurface source = prepareSurface(points, 1);
    const PreparedSurface target = prepareSurface(c.target, 1);
    const SurfaceScorer both = scorerOf(points, source, c.target, target, 4000, 1);
    EXPECT_EQ(both.numPoints(), 4000);
    return std::pair(estimateCalibrated(both, c.prior), c.estimate());
  });
  // Twice as many points, of which every other one would be new if patches had no
  // noise.
  EXPECT_GT(ratio, std::sqrt(0.5));
  EXPECT_LT(ratio, 0.95);
}

TEST(CalibratedEstimate, IsRightAboutASparseTarget)
{
  // Points of a sparse target lie on narrow patches, and the source's points on wide
  // ones: points of one cloud say nothing of what those of the other weigh.
  const double ratio = ratioOfDeviations(600, 500, [](const Case& c) {
    const PreparedSurface source = prepareSurface(c.source, 1);
    const PreparedSurface target = prepareSurface(c.target, 1);
    const SurfaceScorer both = scorerOf(c.source, source, c.target, target, 4000, 1);
    return std::pair(estimateCalibrated(both, c.prior), c.estimate());
  });
  EXPECT_LT(ratio, 1.0);
}

TEST(CalibratedEstimate, IsTheSameTheOtherWay)
{
  for (std::uint64_t stream = 500; stream < 505; ++stream) {
    const Case c{Scans(stream, 2000, 2000)};
    const Matrix3Xd& points = c.scorer.sourcePoints();
    const PreparedSurface source = prepareSurface(points, 1);
    const PreparedSurface target = prepareSurface(c.target, 1);
    const Isometry3d start = Isometry3d::Identity();
    const auto widePrior = [](const Vector3d& reference) {
      return Prior(Vector6d::Zero(), Vector6d::Ones(), reference);
    };
    const CalibratedEstimate forth =
        estimateCalibrated(scorerOf(points, source, c.target, target, 4000, 1),
                           widePrior(c.scorer.centroid()),
                           {},
                           &start);
    const CalibratedEstimate back =
        estimateCalibrated(scorerOf(c.target, target, points, source, 4000, 1),
                           widePrior(c.target.rowwise().mean()),
                           {},
                           &start);
    const Vector6d difference =
        twistBetween(forth.mode, back.mode.inverse(), forth.centre);
    // The modes are found to a hundredth of the noise, which is 0.2 of a deviation of
    // 2000 points.
    EXPECT_LT(test::squaredError(difference, forth.covariance), 6.0 * 0.2 * 0.2)
        << stream;
  }
}

TEST(CalibratedEstimate, UsesAPartOfTheSourceAndNotMoreThanThePatchesCarry)
{
  Random random(101, 300);
  const SurfaceModel fewest(ballAndBox(random, 100).points),
      fewer(ballAndBox(random, 1000).points), few(ballAndBox(random, 3000).points),
      many(ballAndBox(random, 25000).points);
  const auto expectUsed = [&](Index num_points, const SurfaceModel& model, Index most) {
    const Matrix3Xd points = ballAndBox(random, num_points).points;
    const Index num_used =
        evenPoints(points, finiteColumns(points), SurfaceModel(points), model, 6000, 1)
            .cols();
    EXPECT_LE(num_used, most) << num_points;
    // A grid cannot have any number of cubes.
    EXPECT_GT(num_used, 0.95 * static_cast<double>(most)) << num_points;
  };
  expectUsed(1500, many, 1500);
  expectUsed(4000, many, 2000);
  expectUsed(10000, many, 4000);
  expectUsed(30000, many, 6000);
  expectUsed(30000, few, 2000);
  expectUsed(30000, fewer, 1000);
  expectUsed(30000, fewest, 250);
}

TEST(CalibratedEstimate, PutsItsPartsTogether)
{
  const Case c{Scans(100)};
  const CalibratedEstimate e = c.estimate();
  const Matrix6d J_inverse = e.score_covariance.inverse();
  const Matrix6d HT = e.curvature * e.transfer;
  EXPECT_LT((e.information - HT.transpose() * J_inverse * HT).norm(),
            1e-6 * e.information.norm());
  const Matrix6d precision = e.information + e.prior.precision;
  EXPECT_LT((e.covariance * precision - Matrix6d::Identity()).norm(), 1e-6);
  const Vector6d mean =
      -e.covariance * (HT.transpose() * J_inverse * e.scores.total + e.prior.gradient);
  EXPECT_LT((e.mean - mean).norm(), 1e-6 * e.mean.norm());
  EXPECT_LT((e.centre - e.mode * c.scorer.centroid()).norm(), 1e-12);
  for (int k = 0; k < 6; ++k) {
    const Vector6d direction = e.directions.col(k);
    EXPECT_NEAR(direction.dot(e.displacement_metric * direction), 1.0, 1e-9);
  }
  EXPECT_GT(c.scorer.numQueries(), 0);
}

TEST(CalibratedEstimate, DoesNotDependOnItsStartOnAnEasyScene)
{
  const Case c{Scans(101)};
  const CalibratedEstimate two = c.estimate();
  const long num_queries_of_two = c.scorer.numQueries();
  const CalibratedEstimate one = c.estimate({}, &c.truth);
  EXPECT_LT(test::squaredError(two.other_end, two.covariance), 1.0);
  EXPECT_LT(
      test::squaredError(twistBetween(two.mode, one.mode, two.centre), two.covariance),
      1.0);
  EXPECT_LT(one.other_end.norm(), 1e-12);
  EXPECT_LT(c.scorer.numQueries(), 2 * num_queries_of_two);
}

constexpr double wavelength = 0.04;

Matrix3Xd
waves(Random& random, Index num_points, double half)
{
  const double rate = 2.0 * std::acos(-1.0) / wavelength;
  Matrix3Xd points = test::squarePlane(random, num_points, half).points;
  for (Index i = 0; i < num_points; ++i)
    points(2, i) = 0.006 * std::cos(rate * points(0, i)) + 0.0005 * random.normal();
  return points;
}

/** Waves along x: sliding by a wavelength changes nothing but the prior. */
test::Problem
wavesMovedBy(double offset)
{
  Random random(102, 0);
  const Matrix3Xd target = waves(random, 6000, 0.25);
  Matrix3Xd source = waves(random, 800, 0.1);
  source.row(0).array() += offset;
  return {source, target, Vector6d(0.1, 0.02, 0.02, 0.05, 0.05, 0.05)};
}

TEST(CalibratedEstimate, ASingleStartIsFollowedAlone)
{
  const test::Problem problem = wavesMovedBy(0.0);
  for (const int shift : {-1, 0, 1, 2}) {
    Isometry3d start = Isometry3d::Identity();
    start.translation().x() = shift * wavelength + 0.003;
    const CalibratedEstimate e = problem.estimate({}, &start);
    // In its valley; patches are half a wavelength wide.
    EXPECT_NEAR(e.mode.translation().x(), shift * wavelength, 0.1 * wavelength)
        << shift;
  }
}

TEST(CalibratedEstimate, StartsThatEndApartAreTold)
{
  // Half-way between two valleys, which the starts choose between.
  const CalibratedEstimate e = wavesMovedBy(0.5 * wavelength).estimate();
  constexpr double tolerance = 0.1 * wavelength;
  EXPECT_NEAR(std::abs(e.mode.translation().x()), 0.5 * wavelength, tolerance);
  EXPECT_NEAR(std::abs(e.other_end[0]), wavelength, tolerance);
}

} // namespace
} // namespace bayesian_icp
