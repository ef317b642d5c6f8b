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
