#include "geometry/twist.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

namespace bayesian_icp {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/** Translations of about 1 m, rotations of up to 3 rad. */
Vector6d
randomTwist(Random& random)
{
  Vector6d xi = random.normal6();
  xi.tail<3>() = xi.tail<3>().normalized() * 3.0 * random.uniform();
  return xi;
}

Vector3d
randomCentre(Random& random)
{
  return 5.0 * random.normal6().head<3>();
}

/** A prior far from the identity. \param[in] reference source frame [m] */
Prior
randomPrior(Random& random, const Vector3d& reference)
{
  Vector6d variance;
  variance << 0.1, 0.2, 0.05, 0.3, 0.02, 0.1;
  return Prior(test::randomPose(random, 0.8), variance, reference);
}

/** The origin and a point far from it: both prior frames. */
std::array<Vector3d, 2>
references()
{
  return {Vector3d::Zero(), Vector3d(1.5, -2.0, 0.7)};
}

/** Gradient of twistPriorEnergy() by central differences. */
Vector6d
energyGradient(const HeldPrior& prior, const Isometry3d& pose, const Vector3d& centre)
{
  const auto energy = [&](const Vector6d& xi) {
    return twistPriorEnergy(prior, movedBy(xi, centre, pose));
  };
  return test::centralDifferences(energy, Vector6d::Zero());
}

TEST(Twist, MovesPointsAsTheExponentialAboutItsCentreDoes)
{
  Random random(51, 0);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Isometry3d pose = isometryOf(test::randomPose(random));
    const Vector6d xi = randomTwist(random);
    const Vector3d centre = randomCentre(random), point = randomCentre(random);
    const Vector3d arm = pose * point - centre;
    const Vector3d expected = centre + (expSE3(xi) * arm.homogeneous()).head<3>();
    EXPECT_LT((movedBy(xi, centre, pose) * point - expected).norm(), 1e-12);
  }
}

TEST(Twist, BetweenPosesIsTheInverseOfMoving)
{
  Random random(52, 0);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Isometry3d from = isometryOf(test::randomPose(random));
    const Isometry3d to = isometryOf(test::randomPose(random));
    const Vector6d xi = randomTwist(random);
    const Vector3d centre = randomCentre(random);
    EXPECT_LT((twistBetween(from, movedBy(xi, centre, from), centre) - xi).norm(),
              1e-11);
    const Isometry3d back = movedBy(twistBetween(from, to, centre), centre, from);
    EXPECT_LT((back.matrix() - to.matrix()).norm(), 1e-11);
  }
}

TEST(TwistPrior, GradientIsThatOfThePriorsEnergy)
{
  Random random(54, 0);
  for (const Vector3d& reference : references())
    for (int repeat = 0; repeat < 10; ++repeat) {
      const Prior prior = randomPrior(random, reference);
      const Isometry3d pose = isometryOf(test::randomPose(random, 0.8));
      const Vector3d centre = randomCentre(random);
      const Vector6d expected = energyGradient(prior, pose, centre);
      // Central differences of step 1e-5: about 1e-10 in rounding and truncation,
      // times third derivatives of up to 1e3 times the gradient (levers, pitch).
      const Vector6d gradient = twistPriorGradient(prior, pose, centre);
      EXPECT_LT((gradient - expected).norm(), 1e-7 * expected.norm());
      EXPECT_EQ(twistPrior(prior, pose, centre).gradient, gradient);
    }
}

TEST(TwistPrior, GoesOnSmoothlyBeyondAPitchOf90Degrees)
{
  const Prior prior(Vector6d::Zero(), Vector6d::Constant(0.2));
  for (const double pitch : {1.0, 1.6, 2.5}) {
    const Isometry3d pose =
        movedBy(pitch * Vector6d::Unit(4), Vector3d::Zero(), Isometry3d::Identity());
    EXPECT_NEAR(twistPriorEnergy(prior, pose), (1.0 - std::cos(pitch)) / 0.2, 1e-9);
    const Vector6d gradient = twistPriorGradient(prior, pose, Vector3d::Zero());
    EXPECT_LT((gradient - std::sin(pitch) / 0.2 * Vector6d::Unit(4)).norm(), 1e-9);
  }
}

TEST(TwistPrior, PrecisionIsTheHessianAtThePriorsMean)
{
  Random random(55, 0);
  constexpr double step = 1e-4;
  for (const Vector3d& reference : references()) {
    const Prior prior = randomPrior(random, reference);
    const Isometry3d pose = isometryOf(prior.mean());
    const Vector3d centre = randomCentre(random);
    const auto energy = [&](const Vector6d& xi) {
      return prior.energy(poseOf(movedBy(xi, centre, pose).matrix()));
    };
    Matrix6d hessian;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const Vector6d a = step * Vector6d::Unit(i), b = step * Vector6d::Unit(j);
        hessian(i, j) =
            (energy(a + b) - energy(a - b) - energy(b - a) + energy(-a - b)) /
            (4.0 * step * step);
      }
    const TwistPrior result = twistPrior(prior, pose, centre);
    // The differences' error is step^2 = 1e-8 times fourth derivatives of up to 1e3
    // times the second ones.
    EXPECT_LT((result.precision - hessian).norm(), 1e-5 * hessian.norm());
    // The mean's own rounding, times the precision.
    EXPECT_LT(result.gradient.norm(), 1e-13 * hessian.norm());
  }
}

TEST(TwistPrior, DeviationIsTheTwistFromThePriorsMean)
{
  // To first order in the angles: an error of the size of their squares.
  Random random(65, 0);
  constexpr double size = 1e-4;
  const Vector3d reference(0.3, -0.2, 0.1), centre(0.4, 0.5, -0.6);
  const Vector6d mean = test::randomPose(random, 0.8);
  Vector6d turned = mean; // by a whole turn, which is none
  turned[5] += 6.283185307179586;
  const Prior prior(turned, Vector6d::Ones(), reference);
  for (int i = 0; i < 5; ++i) {
    const Vector6d xi = size * randomTwist(random);
    const Isometry3d pose = movedBy(xi, centre, isometryOf(mean));
    EXPECT_LT((twistPrior(prior, pose, centre).deviation - xi).norm(),
              100.0 * size * size);
  }
}

TEST(TwistPrior, PrecisionAwayFromTheMeanFollowsTheDeviation)
{
  Random random(56, 0);
  constexpr double step = 1e-5;
  for (const Vector3d& reference : references()) {
    const Prior prior = randomPrior(random, reference);
    const Isometry3d pose = isometryOf(test::randomPose(random, 0.8));
    const Vector3d centre = randomCentre(random);
    const auto deviation = [&](const Vector6d& xi) {
      return prior.deviation(poseOf(movedBy(xi, centre, pose).matrix()));
    };
    Matrix6d rates;
    for (int k = 0; k < 6; ++k) {
      const Vector6d h = step * Vector6d::Unit(k);
      Vector6d difference = deviation(h) - deviation(-h);
      for (int angle = 3; angle < 6; ++angle)
        difference[angle] = wrapAngle(difference[angle]);
      rates.col(k) = difference / (2.0 * step);
    }
    const Matrix6d expected =
        rates.transpose() * prior.variance().cwiseInverse().asDiagonal() * rates;
    EXPECT_LT((twistPrior(prior, pose, centre).precision - expected).norm(),
              1e-7 * expected.norm());
  }
}

TEST(TwistPrior, SaysNothingOfCoordinatesThatHaveNoPrior)
{
  const double infinity = std::numeric_limits<double>::infinity();
  const Prior prior(Vector6d::Zero(), Vector6d::Constant(infinity));
  Random random(57, 0);
  const TwistPrior result =
      twistPrior(prior, isometryOf(test::randomPose(random)), randomCentre(random));
  EXPECT_EQ(result.precision, Matrix6d::Zero());
  EXPECT_EQ(result.gradient, Vector6d::Zero());
}

TEST(TwistPrior, OfAHoldIsTheGradientOfItsEnergyToo)
{
  Random random(59, 0);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Vector3d reference(0.5, 1.0, -0.3);
    HeldPrior prior(randomPrior(random, reference));
    prior.plane = PlaneHold{reference,
                            random.normal6().head<3>().normalized(),
                            random.normal6().head<3>(),
                            random.normal6().head<3>().normalized(),
                            0.2,
                            0.3};
    const Isometry3d pose = isometryOf(test::randomPose(random, 0.8));
    const Vector3d centre = randomCentre(random);
    const Vector6d expected = energyGradient(prior, pose, centre);
    const Vector6d gradient = twistPriorGradient(prior, pose, centre);
    EXPECT_LT((gradient - expected).norm(), 1e-5 * (1.0 + expected.norm()));
  }
}

TEST(TwistPrior, OfAHoldHasItsHessianWhereThePlanesCoincide)
{
  HeldPrior prior(Prior(Vector6d::Zero(), Vector6d::Constant(1e6)));
  prior.plane = PlaneHold{Vector3d::Zero(),
                          Vector3d::UnitZ(),
                          Vector3d::Zero(),
                          Vector3d::UnitZ(),
                          0.1,
                          0.2};
  Vector6d expected = Vector6d::Zero();
  expected.segment<3>(2) << 100.0, 25.0, 25.0;
  const Matrix6d precision =
      twistPrior(prior, Isometry3d::Identity(), Vector3d::Zero()).precision;
  EXPECT_LT((precision - Matrix6d(expected.asDiagonal())).norm(), 1e-5);
}

TEST(TwistPrior, IsFiniteAtGimbalLock)
{
  Vector6d pose = Vector6d::Zero();
  pose[4] = std::acos(0.0);
  const Prior prior(Vector6d::Zero(), Vector6d::Constant(0.1));
  const TwistPrior result = twistPrior(prior, isometryOf(pose), Vector3d::Ones());
  EXPECT_TRUE(result.precision.allFinite());
  EXPECT_TRUE(result.gradient.allFinite());
}

} // namespace
} // namespace bayesian_icp
