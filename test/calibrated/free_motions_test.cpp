#include "calibrated/calibration_test_support.h"
#include "calibrated/curvature/curvature.h"
#include "calibrated/free_motions.h"
#include "calibrated/modes/robust_mode.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double bar_noise = 0.001;

/** The long faces of a bar along x. */
test::Sheet
barWithoutEnds(Random& random, Index num_points, double half_length)
{
  const Vector3d half(half_length, 0.10, 0.07);
  test::Sheet sheet = test::box(random, num_points, half);
  for (Index i = 0; i < num_points; ++i)
    while (std::abs(sheet.normals(0, i)) > 0.5) {
      const test::Sheet other = test::box(random, 1, half);
      sheet.points.col(i) = other.points.col(0);
      sheet.normals.col(i) = other.normals.col(0);
    }
  return sheet;
}

/** A part of a bar on the bar, at the true pose, where the motion along the bar is
 * free: the last direction, which turns about z on its way. */
struct Bar : test::Problem {
  Bar(const test::Sheet& target, const test::Sheet& source, Random& random)
  : Problem{test::noisy(source, bar_noise, random),
            test::noisy(target, bar_noise, random),
            Vector6d::Constant(0.1)}
  {
    estimate.centre = scorer.centroid();
    estimate.displacement_metric = displacementMetric(scorer, estimate.mode);
    estimate.prior = twistPrior(prior, estimate.mode, estimate.centre);
    estimate.keep << 1.0, 1.0, 1.0, 1.0, 1.0, 0.0;
    for (int k = 0; k < 6; ++k)
      estimate.directions.col(k) =
          k < 5 ? Vector6d::Unit(k + 1)
                : Vector6d(Vector6d::Unit(0) + tilt * Vector6d::Unit(5));
    for (int k = 0; k < 6; ++k)
      estimate.directions.col(k) /= std::sqrt(estimate.directions.col(k).dot(
          estimate.displacement_metric * estimate.directions.col(k)));
  }

  double
  misfit() const
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const SurfaceScores scores =
        test::scoresAt(scorer, estimate.mode, estimate.centre, infinity);
    return contactsOf(cappedResiduals(scores)).misfit;
  }

  /** [rad / m] */
  static constexpr double tilt = 0.3;

  CalibratedEstimate estimate;
};

TEST(FreeMotions, AreTurnedAlongTheSurface)
{
  for (std::uint64_t stream = 0; stream < 5; ++stream) {
    Random random(111, stream);
    const test::Sheet source = barWithoutEnds(random, 600, 0.3);
    Bar bar(barWithoutEnds(random, 6000, 1.0), source, random);
    const Matrix6d before = bar.estimate.directions;
    turnFreeDirections(bar.scorer, bar.prior, bar.misfit(), 1, bar.estimate);
    const CalibratedEstimate& e = bar.estimate;
    EXPECT_EQ(e.directions.leftCols<5>(), before.leftCols<5>());
    const Vector6d direction = e.directions.col(5);
    EXPECT_NEAR(direction.dot(e.displacement_metric * direction), 1.0, 1e-12);
    EXPECT_GT(direction[0], 0.99);
    // The way leads from end to end. An end is known as the noise of both clouds lets
    // it be, a patch having that of many points.
    const Matrix6Xd jacobians = test::distanceJacobians(source);
    const Eigen::Matrix<double, 5, 5> information =
        (jacobians * jacobians.transpose()).bottomRightCorner<5, 5>();
    const double length =
        longestStep(direction, bar.estimate.prior.precision, e.displacement_metric);
    for (int k = 1; k < 6; ++k) {
      const double deviation_of_end =
          std::sqrt(2.0 * information.inverse()(k - 1, k - 1)) * bar_noise;
      const double bound = 4.5 * deviation_of_end / (std::sqrt(2.0) * length);
      EXPECT_NEAR(direction[k], 0.0, bound) << stream << ' ' << k;
      EXPECT_LT(bound, 0.2 * Bar::tilt);
    }
    // Whatever the number of threads.
    CalibratedEstimate again = e;
    again.directions = before;
    turnFreeDirections(bar.scorer, bar.prior, bar.misfit(), 2, again);
    EXPECT_EQ(again.directions, e.directions);
  }
}

TEST(FreeMotions, StayAsTheyAreWhereTheirWayLeavesTheSurface)
{
  // The bar's ends do not fit anywhere but at the mode, however short the way.
  Random random(112, 0);
  const Vector3d half(0.3, 0.10, 0.07);
  const test::Sheet source = test::box(random, 600, half);
  Bar bar(test::box(random, 6000, half), source, random);
  const Matrix6d before = bar.estimate.directions;
  const long num_queries = bar.scorer.numQueries();
  turnFreeDirections(bar.scorer, bar.prior, bar.misfit(), 1, bar.estimate);
  EXPECT_EQ(bar.estimate.directions, before);
  EXPECT_GT(bar.scorer.numQueries(), num_queries + 2 * 600);
}

TEST(FreeMotions, AreHeldAloneByTheirPrecision)
{
  Random random(113, 0);
  CalibratedEstimate e;
  e.directions = test::randomSquare(random);
  e.keep << 1.0, 0.5, 0.0, 1.0, 0.0, 0.1;
  constexpr double tolerance = 0.02;
  const Matrix6d hold = holdOfFree(e, tolerance);
  for (int k = 0; k < 6; ++k) {
    const Vector6d direction = e.directions.col(k);
    EXPECT_NEAR(direction.dot(hold * direction) * tolerance * tolerance,
                e.keep[k] == 0.0 ? 1.0 : 0.0,
                1e-9)
        << k;
  }
}

TEST(FreeMotions, ContactsAreThePointsThatHaveAPatch)
{
  Eigen::VectorXd residuals(4);
  residuals << 1.0, std::numeric_limits<double>::quiet_NaN(), 0.5, 3.0;
  EXPECT_EQ(contactsOf(residuals).share, 0.75);
  EXPECT_EQ(contactsOf(residuals).misfit, 1.5);
}

} // namespace
} // namespace bayesian_icp
