// The viewer's figures against closed forms: spread at a point, standard deviation of
// each point, ellipsoid, cones, camera.
#include "viewer/geometry/camera.h"
#include "viewer/geometry/pose_spread.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/Geometry>

#include <cmath>

namespace bayesian_icp::viewer {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double rounding = 1e-12;

PoseMatrix
randomDraws(Eigen::Index n, const Vector6d& deviations, const Vector6d& mean)
{
  Random random(3, 0);
  PoseMatrix draws(n, 6);
  for (Eigen::Index i = 0; i < n; ++i)
    draws.row(i) =
        canonicalPose(mean + deviations.cwiseProduct(random.normal6())).transpose();
  return draws;
}

Eigen::Matrix3Xd
somePoints()
{
  Eigen::Matrix3Xd points(3, 4);
  points << 0.3, 0.0, -0.1, 2.0, //
      0.4, 0.0, 0.2, -1.0,       //
      1.0, -2.0, 0.5, 0.25;
  return points;
}

/** Straight from the definition. */
double
deviationOf(const Eigen::Vector3d& point, const PoseMatrix& draws)
{
  Eigen::Matrix3Xd moved(3, draws.rows());
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    moved.col(i) = rotationOf(draws.row(i).transpose()) * point +
                   draws.row(i).head<3>().transpose();
  const Eigen::Matrix3Xd centred = moved.colwise() - moved.rowwise().mean();
  return std::sqrt(centred.squaredNorm() / static_cast<double>(draws.rows() - 1));
}

TEST(PointDeviations, AreThoseOfTheMovedPoints)
{
  Vector6d deviations, mean;
  deviations << 0.01, 0.02, 0.005, 0.1, 0.3, 1.0;
  mean << 1.0, -2.0, 0.5, 0.2, -0.4, 3.1;
  const PoseMatrix draws = randomDraws(500, deviations, mean);
  const Eigen::VectorXd found = pointDeviations(somePoints(), draws);
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(found[i], deviationOf(somePoints().col(i), draws), rounding);
}

TEST(PointDeviations, KeepTheirDigitsFarFromTheOrigin)
{
  // A turn about an axis through the cloud, 1e5 m from the origin of the source frame.
  const Eigen::Vector3d far(1e5, -1e5, 0.0);
  PoseMatrix draws = PoseMatrix::Zero(2, 6);
  for (const int sign : {-1, 1}) {
    Vector6d pose = Vector6d::Zero();
    pose[5] = sign * 1e-3;
    pose.head<3>() = far - rotationOf(pose) * far;
    draws.row((sign + 1) / 2) = pose.transpose();
  }
  Eigen::Matrix3Xd points(3, 2);
  points.col(0) = far + Eigen::Vector3d::UnitX();
  points.col(1) = far - Eigen::Vector3d::UnitX();
  // Distance of the two images of a point at radius 1 m: 2 sin(1e-3); sd = that /
  // sqrt 2. The translations of 1e5 m are rounded to 1.5e-11 m.
  const double expected = 2.0 * std::sin(1e-3) / std::sqrt(2.0);
  const Eigen::VectorXd found = pointDeviations(points, draws);
  EXPECT_NEAR(found[0], expected, 1e-10);
  EXPECT_NEAR(found[1], expected, 1e-10);
}

TEST(PointDeviations, OfDrawsThatAreAllAlikeAreZero)
{
  EXPECT_EQ(pointDeviations(somePoints(), PoseMatrix::Zero(5, 6)),
            Eigen::VectorXd::Zero(4));
}

TEST(PoseSpread, SeesAnotherPointOfTheSource)
{
  // Yaw alone varies: the origin stays, a point at radius r moves by r yaw.
  PoseMatrix draws = PoseMatrix::Zero(2, 6);
  draws(0, 5) = -1e-4;
  draws(1, 5) = 1e-4;
  const PoseSpread at_origin = spreadAt(Eigen::Vector3d::Zero(), draws);
  EXPECT_LT(at_origin.positionDeviations()[0], rounding);
  const PoseSpread at_point = spreadAt({2.0, 0.0, 0.0}, draws);
  EXPECT_NEAR(at_point.positionDeviations()[0], 2.0 * 1e-4 * std::sqrt(2.0), 1e-11);
  EXPECT_NEAR(at_point.rotationDeviations()[0], 1e-4 * std::sqrt(2.0), rounding);
  EXPECT_LT(at_point.rotationDeviations()[1], rounding);
}

TEST(PoseSpread, MagnifiesDeviationsOnly)
{
  Vector6d deviations = Vector6d::Constant(0.01), mean;
  mean << 1.0, -2.0, 0.5, 0.2, -0.4, 3.1;
  const PoseMatrix draws = randomDraws(50, deviations, mean);
  const PoseSpread spread = spreadAt({0.5, 0.1, -0.2}, draws);
  const Vector6d draw = draws.row(7).transpose();
  EXPECT_TRUE(magnified(draw, spread, 1.0).isApprox(matrixOf(draw), rounding));
  EXPECT_TRUE(magnified(draw, spread, 0.0).isApprox(spread.meanMatrix(), rounding));
  const Eigen::Vector4d reference = spread.reference.homogeneous();
  const Eigen::Vector4d mean_position = spread.meanMatrix() * reference;
  const Eigen::Vector4d once = matrixOf(draw) * reference - mean_position;
  const Eigen::Vector4d thrice =
      magnified(draw, spread, 3.0) * reference - mean_position;
  EXPECT_TRUE(thrice.isApprox(3.0 * once, 1e-10));
  const auto turnOf = [&](const Eigen::Matrix4d& matrix) -> Eigen::Vector3d {
    return logSO3(matrix.topLeftCorner<3, 3>() *
                  spread.meanMatrix().topLeftCorner<3, 3>().transpose());
  };
  EXPECT_TRUE(turnOf(magnified(draw, spread, 3.0))
                  .isApprox(3.0 * turnOf(matrixOf(draw)), 1e-9));
}

TEST(Shapes, LevelIsThatOf95PercentAnd3DegreesOfFreedom)
{
  const boost::math::chi_squared_distribution<> distribution(3);
  EXPECT_NEAR(
      chi_squared_95_percent_3_dof, boost::math::quantile(distribution, 0.95), 1e-12);
}

TEST(Shapes, EllipsoidIsTheSetOfOneMahalanobisDistance)
{
  Eigen::Matrix3d root;
  root << 3.0, 0.0, 0.0, //
      1.0, 0.5, 0.0,     //
      -2.0, 0.3, 0.01;
  const Eigen::Matrix3d covariance = root * root.transpose();
  const Eigen::Matrix3d axes = regionAxes(covariance, 7.8);
  EXPECT_GT(axes.col(0).norm(), axes.col(1).norm());
  EXPECT_GT(axes.col(1).norm(), axes.col(2).norm());
  EXPECT_NEAR(axes.col(0).dot(axes.col(1)), 0.0, 1e-10);
  Random random(4, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d unit = random.normal6().head<3>().normalized();
    const Eigen::Vector3d whitened =
        root.triangularView<Eigen::Lower>().solve(axes * unit);
    EXPECT_NEAR(whitened.squaredNorm(), 7.8, 1e-6);
  }
}

TEST(Shapes, AxisIsTippedByTurnsAcrossItOnly)
{
  // Turns about z of sd 0.2, about x of 0.05, none about y.
  const Eigen::Matrix3d covariance =
      Eigen::Vector3d(0.05 * 0.05, 0.0, 0.2 * 0.2).asDiagonal();
  const auto along_x = tipAxes(covariance, Eigen::Vector3d::UnitX(), 4.0);
  EXPECT_TRUE(along_x.col(0).cwiseAbs().isApprox(Eigen::Vector3d(0.0, 0.4, 0.0)));
  EXPECT_LT(along_x.col(1).norm(), rounding);
  const auto along_y = tipAxes(covariance, Eigen::Vector3d::UnitY(), 4.0);
  EXPECT_TRUE(along_y.col(0).cwiseAbs().isApprox(Eigen::Vector3d(0.4, 0.0, 0.0)));
  EXPECT_TRUE(along_y.col(1).cwiseAbs().isApprox(Eigen::Vector3d(0.0, 0.0, 0.1)));
}

TEST(Shapes, ConeHasItsAngleAndEndsAtHalfATurn)
{
  const Eigen::Vector3d apex(1.0, 2.0, 3.0), direction = Eigen::Vector3d::UnitZ();
  for (const double angle : {0.1, 2.0, 10.0}) {
    Eigen::Matrix<double, 3, 2> tips = Eigen::Matrix<double, 3, 2>::Zero();
    tips(0, 0) = tips(1, 1) = angle;
    const Eigen::Matrix3Xd cone = coneOf(apex, direction, tips, 0.5);
    EXPECT_EQ(cone.col(0), apex);
    for (Eigen::Index i = 1; i < cone.cols(); ++i) {
      const Eigen::Vector3d rim = cone.col(i) - apex;
      EXPECT_NEAR(rim.norm(), 0.5, rounding);
      EXPECT_NEAR(rim.z() / 0.5, std::cos(std::min(angle, pi)), rounding);
    }
  }
}

TEST(Shapes, ConeWithoutSpreadIsALine)
{
  const Eigen::Matrix3Xd cone = coneOf(Eigen::Vector3d::Zero(),
                                       Eigen::Vector3d::UnitX(),
                                       Eigen::Matrix<double, 3, 2>::Zero(),
                                       2.0);
  for (Eigen::Index i = 1; i < cone.cols(); ++i)
    EXPECT_EQ(cone.col(i), Eigen::Vector3d(2.0, 0.0, 0.0));
}

TEST(Camera, IsAsNearAsTheAreaAllows)
{
  Random random(5, 0);
  Eigen::Matrix3Xd points(3, 200);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    points.col(i) << random.normal(), 3.0 * random.normal(), 0.5 * random.normal();
  const ViewDirection view{Eigen::Vector3d(-0.6, -1.0, 0.6).normalized(),
                           Eigen::Vector3d::UnitZ()};
  const PictureArea area{-0.9, 0.7, -0.8, 0.5};
  constexpr double angle = 0.5, aspect = 1.5;
  const CameraPose camera = fitCamera(points, view, angle, aspect, area);
  const Eigen::Vector3d forward = (camera.focal_point - camera.position).normalized();
  const Eigen::Vector3d right = forward.cross(camera.up).normalized();
  EXPECT_TRUE(forward.isApprox(-view.to_eye, 1e-9));
  double slack = 1.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d offset = points.col(i) - camera.position;
    const double depth = offset.dot(forward) * std::tan(angle / 2.0);
    const double x = offset.dot(right) / (depth * aspect);
    const double y = offset.dot(camera.up) / depth;
    EXPECT_GT(depth, 0.0);
    slack =
        std::min({slack, x - area.left, area.right - x, y - area.bottom, area.top - y});
  }
  EXPECT_NEAR(slack, 0.0, 1e-9);
}

TEST(Camera, LooksFromTheSensorIfThatStandsApart)
{
  Eigen::Matrix3Xd points(3, 2);
  points << -0.1, 0.1, -0.1, 0.1, 0.9, 1.1;
  const ViewDirection optical = defaultView(points, Eigen::Vector3d::Zero());
  EXPECT_TRUE(optical.to_eye.isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(optical.up, -Eigen::Vector3d::UnitY());
  const ViewDirection inside = defaultView(points, {0.0, 0.0, 1.0});
  EXPECT_EQ(inside.up, Eigen::Vector3d::UnitZ());
  const ViewDirection level = defaultView(points, {-5.0, 0.0, 1.0});
  EXPECT_TRUE(level.to_eye.isApprox(-Eigen::Vector3d::UnitX()));
  EXPECT_EQ(level.up, Eigen::Vector3d::UnitZ());
  const CameraPose camera =
      fitCamera(points.leftCols(1), inside, 0.5, 1.0, PictureArea());
  EXPECT_NEAR((camera.position - camera.focal_point).norm(), 1.0, rounding);
}

} // namespace
} // namespace bayesian_icp::viewer
