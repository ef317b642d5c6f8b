// The points that hold a motion along which nearly all of a cloud slides.
#include "calibrated/calibration_test_support.h"
#include "calibrated/surface/facing_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double noise = 0.01;
constexpr Index num_of_wall = 30000, num_of_board = 300;

/** The wall of a tube along z, 40 m long, with a radius of 4 m. */
Matrix3Xd
tube()
{
  Random random(11, 0);
  return test::noisy(test::cylinder(random, num_of_wall, 4.0, 20.0), noise, random);
}

/** The tube and a board across it, 1 m x 1 m, whose points come last. */
Matrix3Xd
tubeWithBoard()
{
  Random random(12, 0);
  Matrix3Xd points(3, num_of_wall + num_of_board);
  points << tube(),
      test::noisy(test::squarePlane(random, num_of_board, 0.5), noise, random)
              .colwise() +
          Vector3d(2.0, 0.0, 3.0);
  return points;
}

std::vector<Index>
facingOf(const Matrix3Xd& points)
{
  std::vector<Index> columns(static_cast<std::size_t>(points.cols()));
  std::iota(columns.begin(), columns.end(), Index(0));
  return pointsFacingRareMotions(points, columns, SurfaceModel(points));
}

TEST(FacingPoints, AreThoseOfABoardAcrossATube)
{
  const std::vector<Index> facing = facingOf(tubeWithBoard());
  // Turning about the tube is as rare, but nothing faces it.
  ASSERT_FALSE(facing.empty());
  EXPECT_TRUE(std::is_sorted(facing.begin(), facing.end()));
  EXPECT_GE(facing.front(), num_of_wall);
  EXPECT_GT(facing.size(), std::size_t(0.8 * num_of_board));
}

TEST(FacingPoints, AreIndicesIntoTheColumns)
{
  const Matrix3Xd points = tubeWithBoard();
  std::vector<Index> columns(num_of_board);
  std::iota(columns.begin(), columns.end(), num_of_wall);
  const std::vector<Index> facing =
      pointsFacingRareMotions(points, columns, SurfaceModel(points));
  ASSERT_GT(facing.size(), std::size_t(0.8 * num_of_board));
  EXPECT_LT(facing.back(), num_of_board);
}

TEST(FacingPoints, AreNoneWhereNothingFacesTheMotion)
{
  EXPECT_TRUE(facingOf(tube()).empty());
}

TEST(FacingPoints, AreNoneWhereManyPatchesHoldEveryMotion)
{
  Random random(13, 0);
  const Vector3d half(3.0, 2.0, 1.0);
  EXPECT_TRUE(facingOf(test::noisy(test::box(random, num_of_wall, half), noise, random))
                  .empty());
}

TEST(FacingPoints, AreNotOnTwoScanLines)
{
  // Some plane through both fits, whatever is between them.
  Matrix3Xd points = tubeWithBoard();
  for (Index i = num_of_wall; i < points.cols(); ++i)
    points(1, i) = i % 2 ? 0.3 : -0.3;
  EXPECT_TRUE(facingOf(points).empty());
}

TEST(FacingPoints, AreNoneWithoutASurface)
{
  EXPECT_TRUE(pointsFacingRareMotions(tube(), {0, 1, 2}, SurfaceModel(Matrix3Xd(3, 0)))
                  .empty());
}

} // namespace
} // namespace bayesian_icp
