#include "calibrated/surface/relative_size.h"
#include "geometry/twist.h"
#include "search/finite_columns.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/** Random points of a square of wavy ground. */
Matrix3Xd
wavyGround(double size, Index num_points)
{
  Random random(11, 0);
  Matrix3Xd points(3, num_points);
  for (Index i = 0; i < num_points; ++i) {
    const double x = size * random.uniform(), y = size * random.uniform();
    points.col(i) << x, y, 0.2 * std::sin(x) * std::cos(y);
  }
  return points;
}

TEST(RelativeSize, AMapHasMorePatchesThanAScan)
{
  const Matrix3Xd scan = wavyGround(10.0, 20000);
  EXPECT_EQ(numDoublings(scan, scan), 0);
  EXPECT_EQ(numDoublings(scan, wavyGround(40.0, 300000)), 0);
  // Scans overlap in part, and one sees more than the other.
  EXPECT_EQ(numDoublings(wavyGround(18.0, 300000), scan), 0);
  EXPECT_EQ(numDoublings(wavyGround(10.0 * std::sqrt(6.0), 300000), scan), 1);
  EXPECT_EQ(numDoublings(wavyGround(10.0 * std::sqrt(12.0), 300000), scan), 2);
  EXPECT_EQ(numDoublings(wavyGround(100.0, 600000), scan), max_doublings);
}

TEST(RelativeSize, NoMorePatchesThanPoints)
{
  const Matrix3Xd scan = wavyGround(10.0, 5000);
  EXPECT_EQ(numDoublings(wavyGround(40.0, 20000), scan), 0);
  EXPECT_EQ(numDoublings(wavyGround(40.0, 40000), scan), 1);
  EXPECT_EQ(numDoublings(wavyGround(40.0, 40001), scan), 2);
}

TEST(RelativeSize, PointsThatAreNotFiniteDoNotCount)
{
  Matrix3Xd scan = wavyGround(10.0, 20000), map = wavyGround(50.0, 300000);
  for (Index i = 0; i < scan.cols(); i += 7)
    scan(1, i) = std::numeric_limits<double>::quiet_NaN();
  for (Index i = 0; i < map.cols(); i += 7)
    map(2, i) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(numDoublings(map, scan), 3);
  // Nor does a stray point.
  map.col(3) << 1e7, -1e7, 1e7;
  EXPECT_EQ(numDoublings(map, wavyGround(10.0, 20000)), 3);
  scan.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(numDoublings(map, scan), 0);
  EXPECT_EQ(numDoublings(scan, map), 0);
  EXPECT_EQ(numDoublings(map, Matrix3Xd(3, 0)), 0);
  EXPECT_EQ(numDoublings(map, Matrix3Xd::Zero(3, 100)), 0);
}

TEST(RelativeSize, TheReachHoldsTheSourceWhereverThePriorLetsItBe)
{
  Random random(12, 0);
  const Matrix3Xd source = wavyGround(4.0, 500).colwise() + Vector3d(6.0, 0.0, 1.0);
  Vector6d mean, variance;
  mean << 1.0, -2.0, 0.5, 0.1, -0.2, 2.0;
  variance << 0.04, 0.01, 0.09, 0.01, 0.0025, 0.04;
  for (const Vector3d& reference : {Vector3d(0.0, 0.0, 0.0), Vector3d(8.0, 2.0, 1.0)}) {
    const Prior prior(mean, variance, reference);
    const Reach reach = reachOf(source, finiteColumns(source), prior);
    double furthest = 0.0;
    for (int run = 0; run < 500; ++run) {
      // On the surface of the three-sigma balls of translation and rotation.
      Vector6d direction;
      for (double& coordinate : direction)
        coordinate = random.normal();
      direction.head<3>().normalize();
      direction.tail<3>().normalize();
      const Vector6d deviation = 3.0 * direction.cwiseProduct(variance.cwiseSqrt());
      Vector6d pose = mean + deviation;
      pose.head<3>() = isometryOf(mean) * reference + deviation.head<3>() -
                       rotationOf(pose) * reference;
      const Matrix3Xd moved = isometryOf(pose) * source;
      furthest = std::max(furthest,
                          (moved.colwise() - reach.centre).colwise().norm().maxCoeff());
    }
    EXPECT_LE(furthest, reach.radius);
    EXPECT_GT(furthest, 0.5 * reach.radius);
  }
}

TEST(RelativeSize, PointsBeyondReachAreLeftOutUnlessFewRemain)
{
  const Matrix3Xd map = wavyGround(40.0, 40000);
  const std::vector<Index> all = finiteColumns(map);
  const std::vector<Index> within =
      columnsWithin({Vector3d(20.0, 20.0, 0.0), 10.0}, map, all);
  EXPECT_NEAR(double(within.size()),
              40000.0 * std::acos(-1.0) * 100.0 / 1600.0,
              5.0 * std::sqrt(7854.0));
  for (const Index column : within)
    EXPECT_LE((map.col(column) - Vector3d(20.0, 20.0, 0.0)).norm(), 10.0);
  EXPECT_EQ(columnsWithin(Reach(), map, all), all);
  EXPECT_EQ(columnsWithin({Vector3d(100.0, 0.0, 0.0), 10.0}, map, all), all);
}

} // namespace
} // namespace bayesian_icp
