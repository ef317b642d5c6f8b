// Points that cover a cloud evenly, whatever its density.
#include "calibrated/surface/even_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xf;

/** A square sheet, 1 m wide, whose density is inversely proportional to the square root
 * of x. */
Matrix3Xf
unevenSheet(Index num_points)
{
  Random random(1, 0);
  Matrix3Xf points(3, num_points);
  for (Index i = 0; i < num_points; ++i) {
    const double u = random.uniform();
    points.col(i) << static_cast<float>(u * u), static_cast<float>(random.uniform()),
        0.f;
  }
  return points;
}

Index
numInCommon(const std::vector<Index>& a, const std::vector<Index>& b)
{
  std::vector<Index> common;
  std::set_intersection(
      a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return static_cast<Index>(common.size());
}

TEST(EvenChoice, CoversASheetEvenly)
{
  const Matrix3Xf points = unevenSheet(100000);
  for (const Index count : {200, 2000, 4000}) {
    const auto chosen = evenChoice(points, count, ChoiceStream::Patches);
    const auto num_chosen = static_cast<double>(chosen.size());
    EXPECT_LE(num_chosen, static_cast<double>(count));
    EXPECT_GE(num_chosen, 0.97 * static_cast<double>(count));
    EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
    EXPECT_EQ(std::adjacent_find(chosen.begin(), chosen.end()), chosen.end());
    // Of all points 71 % are on this half. The cubes of a row that the middle cuts,
    // one in the square root of the count, may belong to either.
    const auto num_left = std::count_if(
        chosen.begin(), chosen.end(), [&](Index i) { return points(0, i) < 0.5f; });
    EXPECT_NEAR(static_cast<double>(num_left),
                0.5 * num_chosen,
                1.5 * std::sqrt(num_chosen) + 1.0);
  }
}

TEST(EvenChoice, TakesTheTailsOfAWallsNoiseOnBothSides)
{
  // The wall is parallel to two axes, and its noise is about as wide as the cubes.
  constexpr Index num_points = 100000, count = 4000;
  Random random(72, 0);
  for (const float noise : {0.004f, 0.006f, 0.008f, 0.01f, 0.012f}) {
    Matrix3Xf points(3, num_points);
    for (Index i = 0; i < num_points; ++i)
      points.col(i) << static_cast<float>(random.uniform()),
          static_cast<float>(random.uniform()),
          noise * static_cast<float>(random.normal());
    double sum = 0.0, sum_of_squares = 0.0;
    for (const Index i : evenChoice(points, count, ChoiceStream::Points)) {
      sum += points(2, i);
      sum_of_squares += points(2, i) * points(2, i);
    }
    // The mean is 0 to within four of its standard deviations.
    EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(sum_of_squares)) << noise;
  }
}

TEST(EvenChoice, ReturnsAllPointsOfASmallCloud)
{
  EXPECT_EQ(evenChoice(unevenSheet(50), 50, ChoiceStream::Points).size(), 50U);
}

TEST(EvenChoice, NeedsNoExtent)
{
  const Matrix3Xf one_place = Matrix3Xf::Constant(3, 100, 2.f);
  const auto chosen = evenChoice(one_place, 10, ChoiceStream::Points);
  EXPECT_GE(chosen.size(), 1U);
  EXPECT_LE(chosen.size(), 10U);
  Matrix3Xf two_places = Matrix3Xf::Zero(3, 100);
  two_places.rightCols(50).setConstant(1e7f);
  const auto of_two = evenChoice(two_places, 10, ChoiceStream::Points);
  EXPECT_LT(of_two.front(), 50);
  EXPECT_GE(of_two.back(), 50);
}

TEST(EvenChoice, OfOneStreamHasPointsInCommonWithAnotherCount)
{
  const Matrix3Xf points = unevenSheet(100000);
  const auto few = evenChoice(points, 2000, ChoiceStream::Points);
  const auto many = evenChoice(points, 4000, ChoiceStream::Points);
  const auto others = evenChoice(points, 4000, ChoiceStream::Patches);
  // A coarse cube's first point is that of its fine cube, too, where it meets few.
  EXPECT_GT(numInCommon(few, many), 1000);
  // By chance: 25 points to choose from in a fine cube.
  EXPECT_LT(numInCommon(few, others), 300);
}

/** A sheet and points that fill the space above it. */
Matrix3Xf
sheetAndStrayPoints(Index num_sheet, Index num_stray)
{
  Matrix3Xf points(3, num_sheet + num_stray);
  points.leftCols(num_sheet) = unevenSheet(num_sheet);
  Random random(1, 1);
  for (Index i = num_sheet; i < points.cols(); ++i)
    points.col(i) << static_cast<float>(random.uniform()),
        static_cast<float>(random.uniform()),
        static_cast<float>(0.2 + 0.8 * random.uniform());
  return points;
}

TEST(WithoutStray, LeavesOutPointsFarFromTheOthers)
{
  // In 0.8 m^3 and 27 cubes of a side of some 0.03 m, the mean number of others around
  // a stray point is 0.8, and four or more are there once in 100 times.
  constexpr Index num_sheet = 20000, num_stray = 1000;
  const auto kept = withoutStray(sheetAndStrayPoints(num_sheet, num_stray), 80000);
  const auto num_kept_of_sheet =
      std::lower_bound(kept.begin(), kept.end(), num_sheet) - kept.begin();
  EXPECT_EQ(num_kept_of_sheet, num_sheet);
  EXPECT_LT(static_cast<Index>(kept.size()) - num_kept_of_sheet, num_stray / 25);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
}

TEST(WithoutStray, FivePointsAreCompany)
{
  Matrix3Xf points = sheetAndStrayPoints(20000, 109);
  points.middleCols(20100, 4).colwise() = Eigen::Vector3f(0.f, 0.f, 2.f);
  points.rightCols(5).colwise() = Eigen::Vector3f(0.f, 0.f, -2.f);
  const auto kept = withoutStray(points, 80000);
  for (Index i = 20100; i < points.cols(); ++i)
    EXPECT_EQ(std::binary_search(kept.begin(), kept.end(), i), i >= 20104) << i;
}

TEST(WithoutStray, KeepsWhereACloudGetsSparse)
{
  // Ground whose density falls with the square of the distance.
  Matrix3Xf points(3, 20000);
  Random random(1, 2);
  for (Index i = 0; i < points.cols(); ++i) {
    const double radius = std::exp(3.0 * random.uniform());
    const double angle = 6.2831853 * random.uniform();
    points.col(i) << static_cast<float>(radius * radius * std::cos(angle)),
        static_cast<float>(radius * radius * std::sin(angle)), 0.f;
  }
  EXPECT_EQ(withoutStray(points, 80000).size(), 20000U);
}

TEST(EvenlyThinned, LeavesAboutTheWantedNumber)
{
  const Matrix3Xf points = unevenSheet(100000);
  const auto thinned = evenlyThinned(points, 20000);
  // Each point is kept by chance.
  EXPECT_NEAR(static_cast<double>(thinned.size()), 20000.0, 5.0 * std::sqrt(20000.0));
  EXPECT_TRUE(std::is_sorted(thinned.begin(), thinned.end()));
}

} // namespace
} // namespace bayesian_icp
