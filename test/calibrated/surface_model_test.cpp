#include "calibrated/calibration_test_support.h"
#include "calibrated/surface/surface_model.h"
#include "sampler/median.h"

#include <bayesian_icp/pose.h>

#include <gtest/gtest.h>

#include <boost/math/distributions/fisher_f.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/** Points of the largest neighbourhood that the noise here asks for. */
constexpr double max_neighbors = 60.0;

SurfaceModelOptions
withoutTakeover()
{
  SurfaceModelOptions options;
  options.takeover_radius = 0.0;
  return options;
}

/** Share of a model's patches of one kind, in [0, 1]. */
double
shareOf(PatchKind kind, const SurfaceModel& model)
{
  const auto count =
      std::count_if(model.patches().begin(),
                    model.patches().end(),
                    [kind](const SurfacePatch& p) { return p.kind == kind; });
  return double(count) / double(model.patches().size());
}

/** Where the surface is said to be at a patch's point, and its normal there. */
struct Projection {
  Vector3d point;
  Vector3d normal;
};

Projection
projectionOf(const SurfaceModel& model, const SurfacePatch& patch)
{
  const SurfaceOffset offset = offsetFrom(patch, patch.centre);
  return {patch.centre - offset.distance * offset.normal + model.origin(),
          offset.normal};
}

// ---- Known surfaces with known noise ----

/** A surface, its noise, and where its truth is. */
struct Known {
  std::string name;
  Matrix3Xd points;
  double sigma;
  /** Signed distance to the true surface, outwards [m]. */
  std::function<double(const Vector3d&)> distance;
  /** True outward normal at the nearest point. */
  std::function<Vector3d(const Vector3d&)> normal;
  /** Sum of the principal curvatures, outwards; of a sphere: -2 / r [1/m]. */
  double sum_of_curvatures;
  /** Whether a point is far from the border of the scan. */
  std::function<bool(const Vector3d&)> is_inside;
};

Known
knownPlane(Random& random)
{
  const double sigma = 0.002;
  return {"plane",
          test::noisy(test::squarePlane(random, 4000, 0.3), sigma, random),
          sigma,
          [](const Vector3d& p) { return p.z(); },
          [](const Vector3d&) { return Vector3d::UnitZ().eval(); },
          0.0,
          [](const Vector3d& p) { return p.head<2>().cwiseAbs().maxCoeff() < 0.24; }};
}

Known
knownSphere(Random& random)
{
  const double sigma = 0.001, radius = 0.1;
  return {"sphere",
          test::noisy(test::sphere(random, 4000, radius), sigma, random),
          sigma,
          [=](const Vector3d& p) { return p.norm() - radius; },
          [](const Vector3d& p) { return p.normalized(); },
          -2.0 / radius,
          [](const Vector3d&) { return true; }};
}

/** Points 1 mm apart on a can. Where the noise is as large as that, neighbourhoods are
 * hardly wider than thick. */
Known
knownCylinder(Random& random, double sigma)
{
  const double radius = 0.033, half_height = 0.03;
  const double pi = std::acos(-1.0), spacing = 0.001;
  const auto num_points =
      static_cast<Index>(2.0 * half_height * 2.0 * pi * radius / (spacing * spacing));
  return {"cylinder",
          test::noisy(
              test::cylinder(random, num_points, radius, half_height), sigma, random),
          sigma,
          [=](const Vector3d& p) { return p.head<2>().norm() - radius; },
          [](const Vector3d& p) { return Vector3d(p.x(), p.y(), 0.0).normalized(); },
          -1.0 / radius,
          [](const Vector3d& p) { return std::abs(p.z()) < 0.022; }};
}

Known
knownSaddle(Random& random)
{
  const double sigma = 0.001, radius = 0.2;
  const auto normal = [=](const Vector3d& p) {
    return Vector3d(-p.x() / radius, p.y() / radius, 1.0).normalized();
  };
  return {"saddle",
          test::noisy(test::saddle(random, 4000, radius, 0.1), sigma, random),
          sigma,
          [=](const Vector3d& p) {
            return (p.z() - (p.x() * p.x() - p.y() * p.y()) / (2.0 * radius)) *
                   normal(p).z();
          },
          normal,
          0.0,
          [](const Vector3d& p) { return p.head<2>().cwiseAbs().maxCoeff() < 0.08; }};
}

std::vector<Known>
knownSurfaces(std::uint64_t stream)
{
  Random random(71, stream);
  return {knownPlane(random),
          knownSphere(random),
          knownCylinder(random, 0.0003),
          knownSaddle(random)};
}

/** What a model says of the inside of a known surface, on average. */
struct MeanErrors {
  double variance_ratio = 0.0;
  double distance = 0.0;
  /** Component-wise, of normals, in the tangent plane; and its mean square. */
  Vector3d normal = Vector3d::Zero();
  double squared_normal = 0.0;
  int count = 0;
};

MeanErrors
meanErrors(const Known& known)
{
  const SurfaceModel model(known.points);
  MeanErrors mean;
  for (const SurfacePatch& patch : model.patches()) {
    const Projection projection = projectionOf(model, patch);
    if (patch.kind != PatchKind::Quadric || !known.is_inside(projection.point))
      continue;
    mean.variance_ratio += std::pow(patch.sigma / known.sigma, 2);
    mean.distance += known.distance(projection.point);
    const Vector3d truth = known.normal(projection.point);
    const double side = projection.normal.dot(truth) < 0.0 ? -1.0 : 1.0;
    const Vector3d error =
        side * projection.normal - truth * std::abs(projection.normal.dot(truth));
    mean.normal += error;
    mean.squared_normal += error.squaredNorm();
    ++mean.count;
  }
  mean.variance_ratio /= mean.count;
  mean.distance /= mean.count;
  mean.normal /= mean.count;
  mean.squared_normal /= mean.count;
  return mean;
}

/** Where the mean distance of projected points lies: selection in the tangent plane of
 * a noisy point sees outer points as rarer by 1 + noise * curvatures, so surfaces are
 * inwards by sigma^2 * curvatures; and every point's noise goes with a weight of one,
 * together, to the patches around it. */
void
expectUnbiasedDistance(const Known& known, const MeanErrors& mean)
{
  const double selection = known.sigma * known.sigma * known.sum_of_curvatures;
  EXPECT_NEAR(mean.distance, selection, 4.0 * known.sigma / std::sqrt(mean.count));
}

TEST(SurfaceModel, FindsKnownSurfacesAndTheirNoise)
{
  for (const Known& known : knownSurfaces(0)) {
    SCOPED_TRACE(known.name);
    const MeanErrors mean = meanErrors(known);
    ASSERT_GT(mean.count, 1500);
    // The mean of sigma^2 is a quadratic form of at most count squared normal variates,
    // whose weights differ by a fifth.
    EXPECT_NEAR(mean.variance_ratio, 1.0, 4.0 * 1.04 * std::sqrt(2.0 / mean.count));
    expectUnbiasedDistance(known, mean);
    const double independent = mean.count / max_neighbors;
    EXPECT_LT(mean.normal.lpNorm<Eigen::Infinity>(),
              4.0 * std::sqrt(mean.squared_normal / independent));
  }
}

TEST(SurfaceModel, ANoisyCanIsNotDrawnInwards)
{
  Random random(72, 0);
  const Known known = knownCylinder(random, 0.0012);
  const MeanErrors mean = meanErrors(known);
  ASSERT_GT(mean.count, 5000);
  expectUnbiasedDistance(known, mean);
}

// ---- Borders, creases, and what points at them take over ----

TEST(SurfaceModel, PointsAtABorderHaveAPlaneAndNoQuadric)
{
  constexpr Index side = 80;
  constexpr double spacing = 0.01, noise = 0.0005;
  Random random(73, 0);
  const Matrix3Xd points = test::noisy(test::gridPlane(side, spacing), noise, random);
  const SurfaceModel model(points, withoutTakeover());
  ASSERT_EQ(model.patches().size(), std::size_t(side * side));
  int num_inside = 0, num_quadrics = 0;
  for (Index i = 0; i < side * side; ++i) {
    const SurfacePatch& patch = model.patches()[static_cast<std::size_t>(i)];
    const Index row = i / side, column = i % side;
    const Index to_border = std::min({row, column, side - 1 - row, side - 1 - column});
    // Half a disc's centroid is 0.42 radii from its centre, a whole one's at it.
    if (to_border == 0) {
      EXPECT_EQ(patch.kind, PatchKind::Plane) << row << " " << column;
      // Its own roughness, of at least 30 points.
      EXPECT_NEAR(patch.sigma / noise, 1.0, 5.0 / std::sqrt(2.0 * 27.0));
    }
    if (double(to_border) * spacing > patch.radius) {
      ++num_inside;
      num_quadrics += patch.kind == PatchKind::Quadric;
    }
  }
  // Of 30 points, the quartic's 9 further terms leave 15 degrees of freedom.
  const double passed = cdf(boost::math::fisher_f(9.0, 15.0), 2.2);
  const double independent = num_inside / 30.0;
  EXPECT_NEAR(double(num_quadrics) / num_inside,
              passed,
              4.0 * std::sqrt(passed * (1.0 - passed) / independent));
  EXPECT_NEAR(model.usableFraction(), 1.0 - shareOf(PatchKind::None, model), 1e-12);
  // Neighbours in a grid: noise across it adds 0.0005^2 / 0.01 to the distance.
  EXPECT_NEAR(model.spacing(), spacing, 0.01 * spacing);
}

TEST(SurfaceModel, PointsAtACreaseTakeOverThePatchOfTheirFace)
{
  Random random(74, 0);
  const Matrix3Xd box =
      test::noisy(test::box(random, 6000, {0.1, 0.08, 0.06}), 0.0003, random);
  const SurfaceModel own(box, withoutTakeover());
  const SurfaceModel model(box);
  int num_taken = 0;
  for (std::size_t j = 0; j < model.patches().size(); ++j) {
    const SurfacePatch& patch = model.patches()[j];
    const Vector3d centre = own.patches()[j].centre;
    EXPECT_EQ(patch.centre, centre);
    if (own.patches()[j].kind == PatchKind::Quadric) {
      EXPECT_EQ(patch.origin, own.patches()[j].origin);
      EXPECT_EQ(patch.sigma, own.patches()[j].sigma);
    }
    else if (patch.kind == PatchKind::Quadric) {
      ++num_taken;
      EXPECT_NE(patch.origin, patch.centre);
      const SurfaceOffset offset = offsetFrom(patch, patch.centre);
      EXPECT_LE(std::abs(offset.distance), 2.5 * patch.sigma);
      EXPECT_LE(offset.in_plane, 0.5 * patch.radius);
    }
  }
  EXPECT_GT(num_taken, 100);
  EXPECT_GT(shareOf(PatchKind::Quadric, model), shareOf(PatchKind::Quadric, own));
}

// ---- Degenerate and special targets ----

bool
areEqual(const SurfacePatch& a, const SurfacePatch& b)
{
  return a.origin == b.origin && a.axes == b.axes && a.quadric == b.quadric &&
         a.centre == b.centre && a.radius == b.radius && a.sigma == b.sigma &&
         a.kind == b.kind;
}

void
expectEqual(const SurfaceModel& a, const SurfaceModel& b)
{
  ASSERT_EQ(a.patches().size(), b.patches().size());
  for (std::size_t j = 0; j < a.patches().size(); ++j)
    ASSERT_TRUE(areEqual(a.patches()[j], b.patches()[j])) << j;
  EXPECT_EQ(a.medianSigma(), b.medianSigma());
  EXPECT_EQ(a.spacing(), b.spacing());
  EXPECT_EQ(a.usableFraction(), b.usableFraction());
}

/** Everything that a model says is a number. */
void
expectFinite(const SurfaceModel& model)
{
  EXPECT_TRUE(std::isfinite(model.medianSigma()));
  EXPECT_TRUE(std::isfinite(model.spacing()));
  EXPECT_TRUE(std::isfinite(model.usableFraction()));
  for (const SurfacePatch& patch : model.patches()) {
    EXPECT_GT(patch.sigma, 0.0);
    EXPECT_TRUE(std::isfinite(patch.radius));
    EXPECT_TRUE(projectionOf(model, patch).point.allFinite());
  }
}

TEST(SurfaceModel, IsTheSameFarFromTheOrigin)
{
  // Multiples of 2^-16 m whose sum over 4096 points is exact even there.
  Random random(75, 0);
  Matrix3Xd points = test::noisy(test::saddle(random, 4096, 0.2, 0.1), 0.001, random);
  points = (points * 65536.0).array().round().matrix() / 65536.0;
  const Vector3d far(512000.0, 5400000.0, 128.0);
  const SurfaceModel model(points);
  const SurfaceModel far_model(Matrix3Xd(points.colwise() + far));
  EXPECT_EQ(far_model.origin(), model.origin() + far);
  expectEqual(far_model, model);
}

TEST(SurfaceModel, LeavesOutPointsThatAreNotFinite)
{
  Random random(77, 0);
  const Matrix3Xd points =
      test::noisy(test::squarePlane(random, 400, 0.1), 0.001, random);
  Matrix3Xd with_holes(3, 403);
  with_holes << points.leftCols(100), Vector3d(nan_value, 0.0, 0.0),
      points.middleCols(100, 200), Vector3d(0.0, 0.0, -HUGE_VAL),
      Vector3d::Constant(nan_value), points.rightCols(100);
  expectEqual(SurfaceModel(with_holes), SurfaceModel(points));
  const SurfaceModel nothing(Matrix3Xd::Constant(3, 5, nan_value));
  EXPECT_TRUE(nothing.patches().empty());
  EXPECT_EQ(nothing.usableFraction(), 0.0);
  EXPECT_EQ(nothing.medianSigma(), 0.0);
}

TEST(SurfaceModel, FewPointsHaveNoQuadricAndFewerNoPlane)
{
  Random random(78, 0);
  for (const Index num_points : {1, 2, 3, 7, 20, 25, 29}) {
    const Matrix3Xd points =
        test::noisy(test::squarePlane(random, num_points, 0.1), 0.001, random);
    const SurfaceModel model(points);
    ASSERT_EQ(model.patches().size(), static_cast<std::size_t>(num_points));
    expectFinite(model);
    // A quartic takes 15 points; with 21 there is a test of the quadric.
    if (num_points <= 20) {
      EXPECT_EQ(shareOf(PatchKind::Quadric, model), 0.0) << num_points;
    }
    if (num_points <= 7) {
      EXPECT_EQ(model.usableFraction(), 0.0) << num_points;
    }
  }
}

/** Level ground under a spinning lidar 1.8 m above it: a ring for every elevation, a
 * point every 0.2 degrees, each off along its beam by noise of 0.02 m, and so on the
 * cone of its ring. The elevation of each point is behind it. */
Eigen::Matrix4Xd
ringsOnTheGround(const std::vector<double>& elevations)
{
  constexpr double degree = 3.14159265358979323846 / 180.0;
  constexpr Index num_azimuths = 1800;
  Random random(96, 0);
  Eigen::Matrix4Xd points(4, num_azimuths * Index(elevations.size()));
  Index next = 0;
  for (const double elevation : elevations)
    for (Index i = 0; i < num_azimuths; ++i) {
      const double up = elevation * degree, azimuth = 0.2 * degree * double(i);
      const double range = -1.8 / std::sin(up) + 0.02 * random.normal();
      const Vector3d beam(std::cos(up) * std::cos(azimuth),
                          std::cos(up) * std::sin(azimuth),
                          std::sin(up));
      points.col(next++) << range * beam, up;
    }
  return points;
}

TEST(SurfaceModel, APointRepeatedALineAndARingOfALidarAreNoSurface)
{
  std::vector<Matrix3Xd> clouds = {Matrix3Xd::Constant(3, 100, 1.5),
                                   Vector3d(1.0, -2.0, 0.5) *
                                       Eigen::RowVectorXd::LinSpaced(200, 0.0, 1.99)};
  for (const double elevation : {-15.0, -9.0, -5.0})
    clouds.push_back(ringsOnTheGround({elevation}).topRows<3>());
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const SurfaceModel model(clouds[i]);
    expectFinite(model);
    EXPECT_EQ(model.usableFraction(), 0.0) << i;
    EXPECT_EQ(model.spacing() == 0.0, i == 0) << i;
  }
}

TEST(SurfaceModel, RingsOfALidarAreGroundAndNotTheirCones)
{
  const Eigen::Matrix4Xd points =
      ringsOnTheGround({-15.0, -13.0, -11.0, -9.0, -7.0, -5.0});
  const SurfaceModel model(points.topRows<3>(), withoutTakeover());
  int num_usable = 0;
  for (const SurfacePatch& patch : model.patches()) {
    if (!patch.isUsable())
      continue;
    ++num_usable;
    EXPECT_EQ(patch.kind, PatchKind::Plane);
    const Vector3d centre = patch.centre + model.origin();
    const double elevation = std::atan2(1.8, centre.head<2>().norm());
    const double slope = std::acos(std::min(1.0, std::abs(patch.axes(2, 2))));
    EXPECT_LT(slope, 0.5 * elevation) << centre.transpose();
  }
  EXPECT_GT(num_usable, int(model.patches().size()) / 2);
}

/** Points of a level strip, 3 m long and 0.1 m wide: along a wave, or at random. */
Matrix3Xd
pointsOfStrip(bool along_wave)
{
  constexpr Index num_points = 600;
  constexpr double half_width = 0.05, wave_length = 0.2;
  const double pi = std::acos(-1.0);
  Random random(97, 0);
  Matrix3Xd points(3, num_points);
  for (Index i = 0; i < num_points; ++i) {
    const double x = 0.005 * double(i);
    const double y = along_wave ? half_width * std::sin(2.0 * pi * x / wave_length)
                                : test::symmetric(random, half_width);
    points.col(i) << x, y, 0.001 * random.normal();
  }
  return points;
}

TEST(SurfaceModel, APlaneOfPointsAlongACurveMayLean)
{
  SurfaceModelOptions planes_only;
  planes_only.max_misfit = 0.0;
  const SurfaceModel of_wave(pointsOfStrip(true), planes_only);
  int num_planes = 0;
  for (const SurfacePatch& patch : of_wave.patches()) {
    if (!patch.isUsable())
      continue;
    ++num_planes;
    EXPECT_TRUE(patch.follows_curve);
    EXPECT_GT(patch.sigma, 0.03 * patch.radius);
  }
  EXPECT_GT(num_planes, 300);

  const SurfaceModel of_scattered(pointsOfStrip(false), planes_only);
  int num_curves = 0;
  for (const SurfacePatch& patch : of_scattered.patches())
    num_curves += patch.follows_curve;
  EXPECT_LT(num_curves, 12);
}

int
numClearNormals(const Matrix3Xd& points)
{
  const SurfaceModel model(points);
  return static_cast<int>(std::count_if(
      model.patches().begin(), model.patches().end(), [](const SurfacePatch& p) {
        return p.has_clear_normal;
      }));
}

TEST(SurfaceModel, APatchHasAClearNormalIfItIsWideAndEvenlyCovered)
{
  constexpr int num_points = 900;
  Random random(98, 0);
  const Matrix3Xd sheet =
      test::noisy(test::squarePlane(random, num_points, 0.5), 0.001, random);
  EXPECT_GT(numClearNormals(sheet), 0.8 * num_points);

  Matrix3Xd lines = sheet; // every 0.25 m, wider apart than a neighbourhood's points
  lines.row(1) = (4.0 * lines.row(1)).array().round() / 4.0;
  EXPECT_LT(numClearNormals(lines), 0.02 * num_points);

  EXPECT_LT(numClearNormals(pointsOfStrip(true)), 0.02 * 600);

  // Noise as thick as the neighbourhoods are wide.
  Matrix3Xd cloud = sheet;
  for (Index k = 0; k < 3; ++k)
    cloud.row(k) += 0.3 * test::normals(random, num_points).transpose();
  EXPECT_LT(numClearNormals(cloud), 0.1 * num_points);
}

TEST(SurfaceModel, PointsThatComeTwiceDoNoHarm)
{
  Random random(79, 0);
  const Matrix3Xd once =
      test::noisy(test::squarePlane(random, 500, 0.1), 0.001, random);
  const SurfaceModel model(Matrix3Xd(once.replicate(1, 2))), expected(once);
  ASSERT_EQ(model.patches().size(), expected.patches().size());
  expectFinite(model);
  // The origin, a mean, is rounded in another way.
  EXPECT_NEAR(
      model.medianSigma(), expected.medianSigma(), 1e-4 * expected.medianSigma());
}

TEST(SurfaceModel, AnExactPlaneIsFoundExactly)
{
  constexpr Index side = 40;
  constexpr double spacing = 0.05;
  const Vector6d tilted(1.0, 2.0, 3.0, 0.4, -0.3, 0.7);
  const Matrix3Xd flat = test::gridPlane(side, spacing).points;
  const Matrix3Xd turned =
      (rotationOf(tilted) * flat).colwise() + Vector3d(tilted.head<3>());
  const Vector3d normal = rotationOf(tilted).col(2);
  const SurfaceModel model(turned);
  // Coordinates are floats of up to 1.5 m.
  constexpr double rounding = 1.2e-7;
  for (const SurfacePatch& patch : model.patches()) {
    EXPECT_LE(patch.sigma, 1.001e-4 * model.spacing());
    const Projection projection = projectionOf(model, patch);
    EXPECT_NEAR(normal.dot(projection.point - tilted.head<3>()), 0.0, rounding);
    EXPECT_NEAR(std::abs(normal.dot(projection.normal)), 1.0, 1e-9);
  }
  EXPECT_GT(shareOf(PatchKind::Quadric, model), 0.9);
}

TEST(SurfaceModel, ExactCurvedSurfacesAreQuadrics)
{
  Random random(80, 0);
  for (const test::Sheet& sheet :
       {test::sphere(random, 2000, 0.1), test::cylinder(random, 2000, 0.03, 0.03)})
    EXPECT_GT(shareOf(PatchKind::Quadric, SurfaceModel(sheet.points)), 0.9);
}

/** Random points of the rectangle at height z, 8000 for each square metre. */
Matrix3Xd
sheetOf(Random& random, double size, double z)
{
  Matrix3Xd points(3, static_cast<Index>(8000.0 * size * size));
  for (Index i = 0; i < points.cols(); ++i)
    points.col(i) << size * random.uniform(), size * random.uniform(), z;
  return points;
}

/** A board above a ground, which it does not touch. Noise is added to heights. */
Matrix3Xd
boardOf(double thickness, double noise)
{
  Random random(81, 0);
  Matrix3Xd points(3, 8000 * 6);
  points << sheetOf(random, 2.0, 0.0), sheetOf(random, 1.0, 0.5),
      sheetOf(random, 1.0, 0.5 + thickness);
  for (Index i = 0; i < points.cols(); ++i)
    points(2, i) += noise * random.normal();
  return points;
}

/** Share of the patches of the board, away from its rim, that lie in one of its faces.
 * \param[in] tolerance of a patch's height [m] */
double
shareInFaces(const SurfaceModel& model, double thickness, double tolerance)
{
  int num_inside = 0, num_in_faces = 0;
  for (const SurfacePatch& patch : model.patches()) {
    const Vector3d centre = patch.centre + model.origin();
    if (centre.z() < 0.4 || centre.head<2>().minCoeff() < 0.1 ||
        centre.head<2>().maxCoeff() > 0.9)
      continue;
    ++num_inside;
    const Projection projection = projectionOf(model, patch);
    const double height = projection.point.z() - 0.5;
    num_in_faces +=
        patch.isUsable() && std::abs(projection.normal.z()) > 0.99 &&
        std::min(std::abs(height), std::abs(height - thickness)) < tolerance;
  }
  return double(num_in_faces) / num_inside;
}

TEST(SurfaceModel, BothSidesOfABoardAreApart)
{
  // Exact: a neighbourhood of 18 points has a radius of 27 mm, and one of 45 has 42 mm.
  EXPECT_GT(shareInFaces(SurfaceModel(boardOf(0.035, 0.0)), 0.035, 3.5e-5), 0.9);
  constexpr double noise = 0.002;
  // A quadric of 30 points has a standard error of 2 / sqrt(30) times their noise.
  constexpr double tolerance = 2.0 * noise;
  // A neighbourhood of 45 points has a radius of 42 mm if both faces are in it.
  for (const double thickness : {0.02, 0.035, 0.05}) {
    const SurfaceModel model(boardOf(thickness, noise));
    EXPECT_GT(shareInFaces(model, thickness, tolerance), 0.95) << thickness;
    EXPECT_NEAR(model.medianSigma(), noise, 0.1 * noise) << thickness;
  }
  // A board that is hardly thicker than the noise is one sheet, halfway between its
  // faces.
  constexpr double thin = 4.0 * noise;
  EXPECT_LT(shareInFaces(SurfaceModel(boardOf(thin, noise)), thin, 0.5 * noise), 0.1);
}

TEST(SurfaceModel, PointsBelowAnEdgeAreNoLayer)
{
  // A step of 20 mm. Its two levels are beside each other, and not one behind the
  // other.
  constexpr double height = 0.02, noise = 0.002;
  Random random(84, 0);
  Matrix3Xd points = sheetOf(random, 1.0, 0.0);
  for (Index i = 0; i < points.cols(); ++i)
    points(2, i) += (points(0, i) > 0.5 ? height : 0.0) + noise * random.normal();
  int num_sharp = 0, num_at_edge = 0;
  const SurfaceModel model(points, withoutTakeover());
  for (const SurfacePatch& patch : model.patches()) {
    const double x = patch.centre.x() + model.origin().x();
    if (std::abs(x - 0.5) > 0.005)
      continue;
    ++num_at_edge;
    num_sharp += patch.kind == PatchKind::Plane && patch.sigma < 2.0 * noise;
  }
  ASSERT_GT(num_at_edge, 40);
  EXPECT_LT(num_sharp, 0.2 * num_at_edge);
}

TEST(SurfaceModel, TheLevelsOfAQuantisedSensorAreNotExact)
{
  // A sensor 2 m above the ground, whose readings come in steps of 4 mm: about 40
  // neighbouring pixels have the same.
  Random random(83, 0);
  Matrix3Xd points = test::gridPlane(120, 0.005).points;
  for (Index i = 0; i < points.cols(); ++i)
    points(2, i) = 0.004 * std::round((0.1 * points(0, i) + 0.05 * points(1, i) +
                                       0.001 * random.normal()) /
                                      0.004);
  const SurfaceModel model(points);
  // Uniform within a step, and the noise.
  EXPECT_GT(model.medianSigma(), 0.001);
  EXPECT_LT(model.medianSigma(), 0.002);
}

TEST(SurfaceModel, DepthInCoarseLevelsIsASurfaceWithNoise)
{
  // A camera looks down on the ground at 45 degrees, 1.2 m above it, and rounds to
  // whole disparities. Many neighbouring pixels are on one level, which faces the
  // camera.
  const Vector3d normal = Vector3d(0.0, 1.0, 1.0).normalized();
  constexpr Index width = 200, height = 150;
  constexpr double focal_length = 150.0, disparity_at_1_m = 31.5;
  Matrix3Xd points(3, width * height);
  for (Index i = 0; i < points.cols(); ++i) {
    const Vector3d ray(double(i % width - width / 2) / focal_length,
                       double(i / width - height / 2) / focal_length,
                       1.0);
    const double depth = 1.2 / normal.dot(ray);
    points.col(i) = disparity_at_1_m / std::round(disparity_at_1_m / depth) * ray;
  }
  const Eigen::Matrix3d turn = rotationOf(Vector6d(0.0, 0.0, 0.0, 0.4, -0.3, 0.7));
  const SurfaceModel model(turn * points);
  const Vector3d turned = turn * normal;
  std::vector<double> cosines;
  for (const SurfacePatch& patch : model.patches())
    cosines.push_back(std::abs(projectionOf(model, patch).normal.dot(turned)));
  EXPECT_GT(medianOf(cosines), 0.99);
  // Levels are 40 mm (near) to 370 mm (far) apart. Rounding and spreading are uniform
  // within a step.
  EXPECT_GT(model.medianSigma(), 0.01);
  EXPECT_LT(model.medianSigma(), 0.1);
}

TEST(SurfaceModel, ALargeFaceOfACadModelIsNotALevelOfDepth)
{
  // A plate with a few posts on it, whose points have as many heights.
  Random random(63, 0);
  Matrix3Xd points(3, 30000);
  for (Index i = 0; i < points.cols(); ++i) {
    const double x = 10.0 * random.uniform(), y = 8.0 * random.uniform();
    points.col(i) = Vector3d(x, y, 0.0);
    if (i % 40 == 0)
      points.col(i) = Vector3d(1.0 + double(i % 3), 0.1 * y, 0.8 * random.uniform());
  }
  EXPECT_LT(SurfaceModel(points).medianSigma(), 1e-4);
}

TEST(SurfaceModel, ASmallNoisyObjectIsNotOneNeighbourhood)
{
  // 3.75 times the noise would ask for 560 neighbours, and those of 480 are too wide
  // for a patch, at 0.28 m. An eighth of the points are within 0.2 m.
  constexpr double noise = 0.08;
  Random random(86, 0);
  Matrix3Xd points(3, 2000);
  for (Index i = 0; i < points.cols(); ++i)
    points.col(i) << random.uniform(), random.uniform(), noise * random.normal();
  const SurfaceModel model(points);
  // Those that are 0.2 m from a border.
  EXPECT_GT(model.usableFraction(), 0.6 * 0.6);
  EXPECT_NEAR(model.medianSigma(), noise, 0.1 * noise);
}

TEST(SurfaceModel, ThinningADenseSurfaceKeepsItsNoiseAndItsPlace)
{
  // 20 points on a square as wide as the noise: cubes that hold one point each of those
  // that are kept are smaller than the noise, and half of them hold its tails only.
  constexpr Index num_points = 40000;
  constexpr double noise = 0.001, width = 0.045;
  Random random(83, 0);
  Matrix3Xd points(3, num_points);
  for (Index i = 0; i < num_points; ++i)
    points.col(i) << width * random.uniform(), width * random.uniform(),
        noise * random.normal();
  SurfaceModelOptions options;
  options.max_patches = 500;
  const SurfaceModel model(points, options);
  // Four points a patch are kept. Five standard errors, of a standard deviation and of
  // a mean.
  const double num_kept = 4.0 * options.max_patches;
  EXPECT_NEAR(model.medianSigma(), noise, 5.0 * noise / std::sqrt(2.0 * num_kept));
  double height = 0.0;
  for (const SurfacePatch& patch : model.patches())
    height += projectionOf(model, patch).point.z();
  EXPECT_NEAR(
      height / double(model.patches().size()), 0.0, 5.0 * noise / std::sqrt(num_kept));
}

TEST(SurfaceModel, PatchesCoverATargetEvenlyHoweverDenseItIs)
{
  // Four fifths of the points are on the first fifth of a square.
  constexpr Index num_points = 30000;
  constexpr double dense = 0.2;
  Random random(82, 0);
  Matrix3Xd points(3, num_points);
  for (Index i = 0; i < num_points; ++i) {
    const double x = i % 5 == 0 ? dense + (1.0 - dense) * random.uniform()
                                : dense * random.uniform();
    points.col(i) << x, random.uniform(), 0.0005 * random.normal();
  }
  SurfaceModelOptions options;
  options.max_patches = 1000;
  const SurfaceModel model(points, options);
  ASSERT_LE(model.patches().size(), std::size_t(1000));
  ASSERT_GE(model.patches().size(), std::size_t(900));
  std::vector<double> dense_radii, other_radii;
  for (const SurfacePatch& patch : model.patches())
    (patch.centre.x() + model.origin().x() < dense ? dense_radii : other_radii)
        .push_back(patch.radius);
  // To within a column of cubes, of which there are 31.
  EXPECT_NEAR(double(dense_radii.size()) / double(model.patches().size()),
              dense,
              1.0 / 31.0 + 0.01);
  // 16 times as dense, four times as narrow, if neighbours were of all points.
  EXPECT_LT(medianOf(other_radii) / medianOf(dense_radii), 1.25);
}

} // namespace
} // namespace bayesian_icp
