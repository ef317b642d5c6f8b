#include "calibrated/calibrated_estimate.h"
#include "calibrated/calibration_test_support.h"
#include "calibrated/surface/even_choice.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>
#include <memory>
#include <numeric>
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
  Vector6d sd;
  sd << 0.02, 0.02, 0.02, 0.05, 0.05, 0.05;
  return sd;
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

/** In random order, as estimateCalibrated() wants them. */
Matrix3Xd
shuffled(const Matrix3Xd& points, Random& random)
{
  std::vector<Index> columns(static_cast<std::size_t>(points.cols()));
  std::iota(columns.begin(), columns.end(), Index(0));
  shuffle(columns, random);
  return points(Eigen::all, columns);
}

/** Two scans, and a true pose from the prior. */
struct Case {
  explicit Case(std::uint64_t stream,
                Index num_source_points = 500,
                Index num_target_points = 2000)
  {
    Random random(101, stream);
    target = test::noisy(ballAndBox(random, num_target_points), sigma, random);
    model = std::make_unique<SurfaceModel>(target);
    const Matrix3Xd seen =
        test::noisy(ballAndBox(random, num_source_points), sigma, random);
    truth = isometryOf(random.normal6().cwiseProduct(priorDeviations()));
    const Vector3d centre = seen.rowwise().mean();
    truth = Eigen::Translation3d(centre) * truth * Eigen::Translation3d(-centre);
    scorer = std::make_unique<SurfaceScorer>(truth.inverse() * shuffled(seen, random),
                                             *model);
    prior = std::make_unique<Prior>(
        Vector6d::Zero(), priorDeviations().cwiseAbs2(), scorer->centroid());
  }

  /** From the posterior mean to the true pose. */
  Vector6d
  error(const CalibratedEstimate& e) const
  {
    return twistBetween(movedBy(e.mean, e.centre, e.mode), truth, e.centre);
  }

  Matrix3Xd target;
  std::unique_ptr<SurfaceModel> model;
  std::unique_ptr<SurfaceScorer> scorer;
  std::unique_ptr<Prior> prior;
  Isometry3d truth = Isometry3d::Identity();
};

TEST(CalibratedEstimate, ErrorsAreAsLargeAsItSays)
{
  constexpr int num_cases = 60;
  double sum = 0.0;
  int num_within = 0;
  const boost::math::chi_squared six(6.0), all(6.0 * num_cases);
  for (int k = 0; k < num_cases; ++k) {
    const Case c(static_cast<std::uint64_t>(k));
    const CalibratedEstimate e = estimateCalibrated(*c.scorer, *c.prior);
    const Vector6d error = c.error(e);
    const double nees = error.dot(e.covariance.ldlt().solve(error));
    sum += nees;
    num_within += nees < quantile(six, 0.95);
  }
  // 99.9 % of sums of 60 NEES, were the posterior exact.
  EXPECT_GT(sum, quantile(all, 0.0005));
  EXPECT_LT(sum, quantile(all, 0.9995));
  // At least 53 of 60 are within, were it 95 %, with a probability of 99.6 %.
  EXPECT_GE(num_within, 53);
}

/** Estimates of several cases, and others of fewer points. */
class Comparison {
public:
  void
  add(const Case& c, const CalibratedEstimate& e, const CalibratedEstimate& other)
  {
    const Vector6d error = c.error(e);
    sum_ += error.dot(e.covariance.ldlt().solve(error));
    log_ratio_ += std::log(e.covariance.determinant() / other.covariance.determinant());
    ++num_cases_;
  }

  /** Whether the sum of NEES is among 99.9 % of those of exact posteriors. */
  void
  expectRight() const
  {
    const boost::math::chi_squared all(6.0 * num_cases_);
    EXPECT_GT(sum_, quantile(all, 0.0005));
    EXPECT_LT(sum_, quantile(all, 0.9995));
  }

  /** Geometric mean of the ratios of deviations. */
  double
  ratio() const
  {
    return std::exp(log_ratio_ / (12.0 * num_cases_));
  }

private:
  double sum_ = 0.0, log_ratio_ = 0.0;
  int num_cases_ = 0;
};

TEST(CalibratedEstimate, MorePointsThanThoseOfTheCurvatureMakeItSharper)
{
  constexpr int num_cases = 40;
  Comparison comparison;
  EstimateOptions options;
  options.num_curvature_points = 500;
  for (int k = 0; k < num_cases; ++k) {
    const Case c(200 + static_cast<std::uint64_t>(k), 2000, 8000);
    const CalibratedEstimate e = estimateCalibrated(*c.scorer, *c.prior, options);
    const CalibratedEstimate of_first =
        estimateCalibrated(c.scorer->ofFirst(500), *c.prior, options);
    comparison.add(c, e, of_first);
  }
  comparison.expectRight();
  // Four times as many points halve the deviations, less what the target's noise adds:
  // if it counted as much as the noise of its 2000 points in the source, by (2 /
  // 5)^1/2.
  EXPECT_GT(comparison.ratio(), 0.5);
  EXPECT_LT(comparison.ratio(), 0.7);
}

TEST(CalibratedEstimate, TheTargetsPointsMakeItSharper)
{
  constexpr int num_cases = 40;
  Comparison comparison;
  for (int k = 0; k < num_cases; ++k) {
    const Case c(400 + static_cast<std::uint64_t>(k), 2000, 2000);
    const Matrix3Xd& points = c.scorer->sourcePoints();
    const PreparedSurface source = prepareSurface(points, 1);
    const SurfaceScorer both = scorerOf(points, source, c.target, *c.model, 4000, 1);
    ASSERT_EQ(both.numPoints(), 4000);
    const CalibratedEstimate e = estimateCalibrated(both, *c.prior);
    const CalibratedEstimate of_source = estimateCalibrated(*c.scorer, *c.prior);
    comparison.add(c, e, of_source);
  }
  comparison.expectRight();
  // Twice as many points, of which every other one would be new if patches had no
  // noise.
  EXPECT_GT(comparison.ratio(), std::sqrt(0.5));
  EXPECT_LT(comparison.ratio(), 0.95);
}

TEST(CalibratedEstimate, IsTheSameTheOtherWay)
{
  for (std::uint64_t stream = 500; stream < 505; ++stream) {
    const Case c(stream, 2000, 2000);
    const Matrix3Xd& points = c.scorer->sourcePoints();
    const PreparedSurface source = prepareSurface(points, 1);
    const PreparedSurface target = prepareSurface(c.target, 1);
    const Isometry3d start = isometryOf(c.prior->mean());
    const Prior wide(poseOf(start.matrix()), Vector6d::Ones(), c.scorer->centroid());
    const CalibratedEstimate forth = estimateCalibrated(
        scorerOf(points, source, c.target, target.model, 4000, 1), wide, {}, &start);
    const Isometry3d back_start = start.inverse();
    const Prior wide_back(
        poseOf(back_start.matrix()), Vector6d::Ones(), c.target.rowwise().mean());
    const CalibratedEstimate back =
        estimateCalibrated(scorerOf(c.target, target, points, source.model, 4000, 1),
                           wide_back,
                           {},
                           &back_start);
    const Vector6d difference =
        twistBetween(forth.mode, back.mode.inverse(), forth.centre);
    // The modes are found to a hundredth of the noise, which is 0.2 of a deviation of
    // 2000 points.
    EXPECT_LT(difference.dot(forth.covariance.ldlt().solve(difference)),
              6.0 * 0.2 * 0.2)
        << stream;
  }
}

TEST(CalibratedEstimate, UsesAPartOfTheSourceAndNotMoreThanThePatchesCarry)
{
  Random random(101, 300);
  const SurfaceModel few(ballAndBox(random, 3000).points),
      many(ballAndBox(random, 25000).points);
  const auto expectUsed = [&](Index num_points, const SurfaceModel& model, Index most) {
    const Matrix3Xd points = ballAndBox(random, num_points).points;
    const Index num_used = evenPoints(points, model, 6000, 1).cols();
    EXPECT_LE(num_used, most) << num_points;
    // A grid cannot have any number of cubes.
    EXPECT_GT(num_used, 0.95 * static_cast<double>(most)) << num_points;
  };
  expectUsed(1500, many, 1500);
  expectUsed(4000, many, 2000);
  expectUsed(10000, many, 4000);
  expectUsed(30000, many, 6000);
  expectUsed(30000, few, 2000);
}

TEST(CalibratedEstimate, PutsItsPartsTogether)
{
  const Case c(100);
  const CalibratedEstimate e = estimateCalibrated(*c.scorer, *c.prior);
  const Matrix6d J_inverse = e.score_covariance.inverse();
  const Matrix6d HT = e.curvature * e.transfer;
  EXPECT_LT((e.information - HT.transpose() * J_inverse * HT).norm(),
            1e-6 * e.information.norm());
  const Matrix6d precision = e.information + e.prior.precision;
  EXPECT_LT((e.covariance * precision - Matrix6d::Identity()).norm(), 1e-6);
  const Vector6d mean =
      -e.covariance * (HT.transpose() * J_inverse * e.scores.total + e.prior.gradient);
  EXPECT_LT((e.mean - mean).norm(), 1e-6 * e.mean.norm());
  EXPECT_LT((e.centre - e.mode * c.scorer->centroid()).norm(), 1e-12);
  for (int k = 0; k < 6; ++k) {
    const Vector6d direction = e.directions.col(k);
    EXPECT_NEAR(direction.dot(e.displacement_metric * direction), 1.0, 1e-9);
  }
  EXPECT_GT(e.num_queries, 0);
}

TEST(CalibratedEstimate, DoesNotDependOnItsStartOnAnEasyScene)
{
  const Case c(101);
  const CalibratedEstimate two = estimateCalibrated(*c.scorer, *c.prior);
  const CalibratedEstimate one =
      estimateCalibrated(*c.scorer, *c.prior, EstimateOptions(), &c.truth);
  const auto distance = [&](const Vector6d& xi) {
    return std::sqrt(xi.dot(two.covariance.ldlt().solve(xi)));
  };
  EXPECT_LT(distance(two.other_end), 1.0);
  EXPECT_LT(distance(twistBetween(two.mode, one.mode, two.centre)), 1.0);
  EXPECT_LT(one.other_end.norm(), 1e-12);
  EXPECT_LT(one.num_queries, two.num_queries);
}

/** Waves along x: sliding by a wavelength changes nothing but the prior. */
struct Waves {
  static constexpr double wavelength = 0.04;

  explicit Waves(double offset)
  {
    Random random(102, 0);
    model = std::make_unique<SurfaceModel>(waves(random, 6000, 0.25));
    Matrix3Xd source = waves(random, 800, 0.1);
    source.row(0).array() += offset;
    scorer = std::make_unique<SurfaceScorer>(source, *model);
    Vector6d sd = priorDeviations();
    sd[0] = 0.1;
    prior =
        std::make_unique<Prior>(Vector6d::Zero(), sd.cwiseAbs2(), scorer->centroid());
  }

  static Matrix3Xd
  waves(Random& random, Index num_points, double half)
  {
    const double rate = 2.0 * std::acos(-1.0) / wavelength;
    Matrix3Xd points = test::squarePlane(random, num_points, half).points;
    for (Index i = 0; i < num_points; ++i)
      points(2, i) = 0.006 * std::cos(rate * points(0, i)) + 0.0005 * random.normal();
    return points;
  }

  std::unique_ptr<SurfaceModel> model;
  std::unique_ptr<SurfaceScorer> scorer;
  std::unique_ptr<Prior> prior;
};

TEST(CalibratedEstimate, ASingleStartIsFollowedAlone)
{
  const Waves waves(0.0);
  for (const int shift : {-1, 0, 1, 2}) {
    Isometry3d start = Isometry3d::Identity();
    start.translation().x() = shift * Waves::wavelength + 0.003;
    const CalibratedEstimate e =
        estimateCalibrated(*waves.scorer, *waves.prior, EstimateOptions(), &start);
    // In its valley; patches are half a wavelength wide.
    EXPECT_NEAR(
        e.mode.translation().x(), shift * Waves::wavelength, 0.1 * Waves::wavelength)
        << shift;
  }
}

TEST(CalibratedEstimate, StartsThatEndApartAreTold)
{
  // Half-way between two valleys, which the starts choose between.
  const Waves waves(0.5 * Waves::wavelength);
  const CalibratedEstimate e = estimateCalibrated(*waves.scorer, *waves.prior);
  constexpr double tolerance = 0.1 * Waves::wavelength;
  EXPECT_NEAR(std::abs(e.mode.translation().x()), 0.5 * Waves::wavelength, tolerance);
  EXPECT_NEAR(std::abs(e.other_end[0]), Waves::wavelength, tolerance);
}

} // namespace
} // namespace bayesian_icp
