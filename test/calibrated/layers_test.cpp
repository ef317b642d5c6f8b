#include "calibrated/surface/layers.h"
#include "support/test_support.h"

#include <bayesian_icp/pose.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;

constexpr Index num_of_disc = 60;
constexpr double disc_noise = 0.05;

/** Random points of the unit disc, with noise across it. */
PointRows
disc(Random& random)
{
  PointRows points(num_of_disc, 3);
  for (Index i = 0; i < num_of_disc; ++i) {
    const double r = std::sqrt(random.uniform()), angle = 6.2831853 * random.uniform();
    points.row(i) << r * std::cos(angle), r * std::sin(angle),
        disc_noise * random.normal();
  }
  return points;
}

/** A disc and one that is \p shift away, relative to the first point of the first. */
PointRows
twoDiscs(Random& random, const Vector3d& shift)
{
  PointRows points(2 * num_of_disc, 3);
  points << disc(random), disc(random).rowwise() + shift.transpose();
  return points.rowwise() - RowVector3d(points.row(0));
}

std::optional<Layer>
layerOf(const PointRows& points)
{
  const RowVector3d mean = points.colwise().mean();
  const PointRows centred = points.rowwise() - mean;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(
      centred.transpose() * centred / static_cast<double>(points.rows()));
  return ownLayer(points,
                  {mean.transpose(),
                   solver.eigenvectors().rowwise().reverse(),
                   solver.eigenvalues().reverse()});
}

TEST(Layers, TheFacesOfAWallAreLayers)
{
  Random random(1, 0);
  for (int run = 0; run < 100; ++run)
    for (const double height : {0.7, -0.7}) {
      PointRows points = twoDiscs(random, {0.0, 0.0, height});
      const Matrix3d R = rotationOf(test::randomPose(random));
      points = points * R.transpose();
      const std::optional<Layer> layer = layerOf(points);
      ASSERT_TRUE(layer) << run;
      // Halfway, to five standard errors; the origin is off its layer by its noise.
      const double length = layer->axis.norm();
      EXPECT_NEAR(std::abs(layer->threshold) / length, 0.35, 5.0 * disc_noise);
      EXPECT_GT(std::abs(layer->axis.dot(R.col(2))) / length, 0.99);
      PointRows kept = points;
      keepLayer(*layer, kept);
      EXPECT_EQ(kept, points.topRows(num_of_disc));
    }
}

TEST(Layers, OneSheetIsNotTwo)
{
  Random random(2, 0);
  for (int run = 0; run < 1000; ++run) {
    PointRows points = disc(random);
    points.rowwise() -= RowVector3d(points.row(0));
    EXPECT_FALSE(layerOf(points)) << run;
  }
}

TEST(Layers, SheetsNearOrBesideEachOtherAreNoLayers)
{
  Random of_near(3, 0), of_beside(4, 0);
  for (int run = 0; run < 100; ++run) {
    EXPECT_FALSE(layerOf(twoDiscs(of_near, {0.0, 0.0, 4.0 * disc_noise}))) << run;
    EXPECT_FALSE(layerOf(twoDiscs(of_beside, {1.2, 0.0, 0.7}))) << run;
  }
}

TEST(Layers, AFewPointsAreNoLayer)
{
  Random random(5, 0);
  for (const Index num_behind : {6, 30}) {
    PointRows points =
        twoDiscs(random, {0.0, 0.0, 0.7}).topRows(num_of_disc + num_behind);
    EXPECT_EQ(layerOf(points).has_value(), num_behind == 30);
  }
}

TEST(Layers, TwoLinesAreNoLayers)
{
  // Rings of a LiDAR on the ground.
  Random random(6, 0);
  for (const double gap : {0.05, 0.2, 0.5})
    for (int run = 0; run < 100; ++run) {
      PointRows points(num_of_disc, 3);
      for (Index i = 0; i < num_of_disc; ++i)
        points.row(i) << random.uniform() - 0.5, i % 2 ? gap : 0.0,
            0.01 * random.normal();
      points.rowwise() -= RowVector3d(points.row(0));
      EXPECT_FALSE(layerOf(points)) << gap;
    }
}

} // namespace
} // namespace bayesian_icp
