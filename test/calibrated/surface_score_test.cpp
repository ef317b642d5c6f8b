#include "calibrated/calibration_test_support.h"
#include "geometry/twist.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();

/** Tukey's rho of a residual u at scale tau, whose derivative is psi(u). */
double
tukeyEnergy(double u, double tau)
{
  const double c = SurfaceScorer::tukey_constant * tau;
  const double z = std::min(1.0, std::abs(u / c));
  return c * c / 6.0 * (1.0 - std::pow(1.0 - z * z, 3));
}

/** A plane that every patch knows exactly, and points around it: some too far off it to
 * count, and some beyond its border. */
struct PlaneCase {
  PlaneCase()
  {
    Random random(61, 0);
    // Patches of exact points have a noise of 1e-4 spacings.
    const double sigma = model.medianSigma();
    Matrix3Xd points(3, 60);
    for (Index i = 0; i < points.cols(); ++i) {
      const double x = 0.3 + 1.4 * random.uniform(), y = 0.3 + 1.4 * random.uniform();
      points.col(i) << x, y, 3.0 * tau * sigma * random.normal();
    }
    points.col(7).x() += 4.0;
    points.col(33).y() -= 4.0;
    points.col(8).z() = 20.0 * tau * sigma;
    source = pose.inverse() * points;
  }

  SurfaceScores
  scoresAt(const Isometry3d& T_target_source, double scale) const
  {
    return test::scoresAt(
        SurfaceScorer(source, model), T_target_source, centre(), scale);
  }

  static bool
  hasPatch(Index i)
  {
    return i != 7 && i != 33;
  }

  /** Expects the gradients of Tukey's energy.
   * \param[in] heightOf point i over the plane after a twist [m] */
  template <typename Height>
  void
  expectGradients(const Matrix6Xd& scores, const Height& heightOf) const
  {
    const double sigma = model.medianSigma();
    for (Index i = 0; i < source.cols(); ++i) {
      const auto energy = [&](const Vector6d& xi) {
        return tukeyEnergy(heightOf(xi, i) / sigma, tau);
      };
      const Vector6d expected =
          hasPatch(i) ? test::centralDifferences(energy, Vector6d::Zero(), step())
                      : Vector6d::Zero();
      // Differences of 0.01 in u: (0.01)^2 / 6 times a third derivative of less than
      // 12 / (4.685 tau)^2, and levers of 1.5 m.
      EXPECT_LT((scores.col(i) - expected).norm(), 2e-4 / sigma) << i;
    }
  }

  Vector3d
  centre() const
  {
    return {0.9, 1.1, 0.2};
  }

  /** Steps of twists at which the residuals move by a hundredth. */
  double
  step() const
  {
    return 0.01 * model.medianSigma();
  }

  SurfaceModel model{test::gridPlane(40, 0.05).points};
  /** Anywhere in the source frame. */
  Isometry3d pose = isometryOf({0.4, -0.2, 1.0, 0.5, -0.4, 2.0});
  double tau = 1.7;
  Matrix3Xd source;
};

TEST(SurfaceScore, ResidualsAreHeightsOverAKnownPlane)
{
  const PlaneCase c;
  const SurfaceScores scores = c.scoresAt(c.pose, c.tau);
  const Matrix3Xd moved = c.pose * c.source;
  int num_with_patch = 0, num_active = 0;
  for (Index i = 0; i < moved.cols(); ++i) {
    const auto index = static_cast<std::size_t>(i);
    const bool is_inside = PlaneCase::hasPatch(i);
    EXPECT_EQ(bool(scores.has_patch[index]), is_inside) << i;
    const double u = is_inside ? moved(2, i) / c.model.medianSigma() : 0.0;
    // Moving there and back rounds at 1e-16 m, of a noise of 5e-6 m.
    EXPECT_NEAR(std::abs(scores.residuals[i]), std::abs(u), 1e-8) << i;
    const bool is_active =
        is_inside && std::abs(u) < SurfaceScorer::tukey_constant * c.tau;
    EXPECT_EQ(bool(scores.active[index]), is_active) << i;
    num_with_patch += is_inside;
    num_active += is_active;
  }
  EXPECT_EQ(scores.num_active, num_active);
  EXPECT_LT(num_active, num_with_patch);
}

TEST(SurfaceScore, PointsBeyondABorderAreOnTheContinuationOrOffIt)
{
  PlaneCase c;
  // 3 m beyond the border, slopes that are uncertain by twice the noise over a patch's
  // radius are off by less than 0.02 m.
  const Matrix3Xd source = c.source;
  const auto offOf = [&](double height) {
    c.source = source;
    c.source.col(7) += c.pose.linear().transpose() * Vector3d(0.0, 0.0, height);
    return c.scoresAt(c.pose, c.tau).off_continuation;
  };
  const Eigen::VectorXd on = offOf(0.0), off = offOf(0.1);
  EXPECT_LT(on[7], 0.01);
  EXPECT_LT(on[33], 0.01);
  EXPECT_EQ(off[7], 1.0);
  EXPECT_EQ(off[33], on[33]);
  EXPECT_EQ(on[8], 0.0); // has a patch
}

TEST(SurfaceScore, IsTheGradientOfTukeysEnergy)
{
  const PlaneCase c;
  const SurfaceScores scores = c.scoresAt(c.pose, c.tau);
  c.expectGradients(scores.scores, [&](const Vector6d& xi, Index i) {
    return (movedBy(xi, c.centre(), c.pose) * c.source.col(i)).z();
  });
  const Vector6d sum = scores.scores.rowwise().sum();
  EXPECT_LT((scores.total - sum).norm(), 1e-12 * scores.scores.norm());
}

TEST(SurfaceScore, OfATargetPointIsTheGradientToo)
{
  // The plane is the source here, and the points about it are the target's.
  const PlaneCase c;
  const Isometry3d T_target_source = c.pose.inverse();
  const Vector3d centre = T_target_source * c.centre();
  const Matrix3Xd source_point = Vector3d(50.0, 0.0, 0.0);
  SurfaceScorer scorer(source_point, c.model);
  scorer.addTargetPoints(c.source, c.model);
  const SurfaceScores scores = test::scoresAt(scorer, T_target_source, centre, c.tau);

  ASSERT_EQ(scores.residuals.size(), 1 + c.source.cols());
  EXPECT_EQ(scores.num_source_points, 1);
  EXPECT_EQ(scores.num_active_of_source, 0);
  EXPECT_EQ(cappedResiduals(scores).size(), 1);
  // All as if the points were the source's.
  const SurfaceScores other_way = c.scoresAt(c.pose, c.tau);
  EXPECT_EQ(scores.num_active, other_way.num_active);
  EXPECT_LT((scores.residuals.tail(c.source.cols()) - other_way.residuals).norm(),
            1e-7);
  c.expectGradients(scores.scores.rightCols(c.source.cols()),
                    [&](const Vector6d& xi, Index i) {
                      const Isometry3d moved = movedBy(xi, centre, T_target_source);
                      return (moved.inverse() * c.source.col(i)).z();
                    });
  PatchHints hints;
  Vector6d total;
  scorer.batchScore(T_target_source, centre, c.tau, {0, 3, 12}, hints, total);
  EXPECT_LT((total - scores.scores.col(3) - scores.scores.col(12)).norm(),
            1e-12 * scores.scores.norm());
}

/** The plane of PlaneCase with this noise, and every k-th row and column of it. */
SurfaceModel
noisyPlane(double noise, Index k)
{
  Random random(62, 0);
  Matrix3Xd points = test::gridPlane(40 / k, 0.05 * double(k)).points;
  for (Index i = 0; i < points.cols(); ++i)
    points(2, i) += noise * random.normal();
  return SurfaceModel(points);
}

TEST(SurfaceScore, PatchesAreNotKnownBetterThanThePointsThatMeetThem)
{
  // The plane is exact. Its points are compared with a copy of it.
  const PlaneCase c;
  const double own = c.model.medianSigma();
  SurfaceScorer scorer(c.source, c.model);
  scorer.addTargetPoints(c.pose * c.source, c.model);
  const auto residuals = [&] {
    return test::scoresAt(scorer, c.pose, c.centre(), infinity).residuals;
  };
  const Index count = c.source.cols();
  const Eigen::VectorXd alone = residuals();
  EXPECT_EQ(scorer.noise(), own);
  // Patches of the source never change.
  const auto expectSigma = [&](double sigma) {
    EXPECT_LT((residuals().head(count) - alone.head(count) * own / sigma).norm(),
              1e-9 * alone.norm());
    EXPECT_EQ(residuals().tail(count), alone.tail(count));
    EXPECT_EQ(scorer.noise(), sigma);
    EXPECT_EQ(scorer.ofFirst(10).noise(), sigma);
  };
  scorer.setSourceNoise(c.model);
  expectSigma(own);
  const SurfaceModel noisy = noisyPlane(0.01, 1);
  scorer.setSourceNoise(noisy);
  expectSigma(std::min(1.0, c.model.medianRadius() / noisy.medianRadius()) *
                  noisy.medianSigma() -
              0.7 * own);
  // A cloud with a quarter of the points has patches of twice the radius.
  const SurfaceModel sparse = noisyPlane(0.01, 2);
  scorer.setSourceNoise(sparse);
  EXPECT_NEAR(sparse.medianRadius() / noisy.medianRadius(), 2.0, 0.2);
  EXPECT_NEAR(scorer.noise() / (c.model.medianRadius() / sparse.medianRadius() * 0.01),
              1.0,
              0.1);
}

TEST(SurfaceScore, FirstPointsAreTheSameShareOfEachCloud)
{
  Random random(65, 0);
  const SurfaceModel model(test::randomPoints(random, 10));
  const Matrix3Xd source = test::randomPoints(random, 30),
                  target = test::randomPoints(random, 20);
  SurfaceScorer scorer(source, model);
  EXPECT_EQ(scorer.ofFirstOfBoth(10).sourcePoints(), source.leftCols(10));
  scorer.addTargetPoints(target, model);
  const Isometry3d pose = isometryOf(random.normal6());
  const auto points = [&](const SurfaceScorer& of) { return of.pointsAt(pose); };
  Matrix3Xd expected(3, 10);
  expected << source.leftCols(6), pose.inverse() * target.leftCols(4);
  EXPECT_EQ(points(scorer.ofFirstOfBoth(10)), expected);
  EXPECT_EQ(scorer.ofFirstOfBoth(10).centroid(), scorer.centroid());
  EXPECT_EQ(points(scorer.ofFirst(10)), source.leftCols(10));
  EXPECT_EQ(points(scorer.ofFirstOfBoth(1000)), points(scorer));
}

TEST(SurfaceScore, InformationIsThatOfWeightedResiduals)
{
  const PlaneCase c;
  const SurfaceScores scores = c.scoresAt(c.pose, c.tau);
  std::array<Eigen::VectorXd, 6> rates;
  for (int k = 0; k < 6; ++k) {
    const Vector6d h = c.step() * Vector6d::Unit(k);
    rates[static_cast<std::size_t>(k)] =
        (c.scoresAt(movedBy(h, c.centre(), c.pose), c.tau).residuals -
         c.scoresAt(movedBy(-h, c.centre(), c.pose), c.tau).residuals) /
        (2.0 * c.step());
  }
  Matrix6d expected = Matrix6d::Zero();
  for (Index i = 0; i < c.source.cols(); ++i) {
    Vector6d gradient;
    for (int k = 0; k < 6; ++k)
      gradient[k] = rates[static_cast<std::size_t>(k)][i];
    const double z = std::min(
        1.0, std::abs(scores.residuals[i]) / (SurfaceScorer::tukey_constant * c.tau));
    expected += std::pow(1.0 - z * z, 2) * gradient * gradient.transpose();
  }
  // Heights are linear in the twist but for its square, 1e-8 of a lever.
  EXPECT_LT((scores.information - expected).norm(), 1e-6 * expected.norm());
  EXPECT_LT(
      (scores.jacobians * scores.jacobians.transpose() - scores.information).norm(),
      1e-12 * expected.norm());
}

TEST(SurfaceScore, InfiniteScaleIsLeastSquares)
{
  const PlaneCase c;
  const SurfaceScores scores = c.scoresAt(c.pose, infinity);
  EXPECT_EQ(scores.active, scores.has_patch);
  EXPECT_EQ(scores.num_active, c.source.cols() - 2);
  for (Index i = 0; i < c.source.cols(); ++i)
    EXPECT_LT(
        (scores.scores.col(i) - scores.residuals[i] * scores.jacobians.col(i)).norm(),
        1e-12 * (1.0 + scores.scores.col(i).norm()));
}

/** A noisy sphere and a second scan of it. */
struct SphereCase {
  Matrix3Xd
  scan(Index num_points)
  {
    return test::noisy(test::sphere(random, num_points, 0.2), 0.002, random);
  }

  Random random{62, 0};
  SurfaceModel model{scan(1500)};
  Matrix3Xd source = scan(300);
};

TEST(SurfaceScore, UsesThePatchWhoseProjectedPointIsNearest)
{
  const SphereCase c;
  const SurfaceScores scores = test::scoresAt(
      SurfaceScorer(c.source, c.model), Isometry3d::Identity(), Vector3d::Zero(), 1.0);
  for (Index i = 0; i < c.source.cols(); ++i) {
    const Vector3d point = c.source.col(i) - c.model.origin();
    double nearest = infinity;
    const SurfacePatch* patch = nullptr;
    for (const SurfacePatch& candidate : c.model.patches()) {
      const SurfaceOffset own = offsetFrom(candidate, candidate.centre);
      const double distance =
          (candidate.centre - own.distance * own.normal - point).norm();
      if (distance < nearest) {
        nearest = distance;
        patch = &candidate;
      }
    }
    const SurfaceOffset offset = offsetFrom(*patch, point);
    const bool has_patch =
        patch->isUsable() &&
        offset.in_plane <= SurfaceScorer::max_in_plane * patch->radius;
    EXPECT_EQ(bool(scores.has_patch[static_cast<std::size_t>(i)]), has_patch) << i;
    EXPECT_NEAR(
        scores.residuals[i], has_patch ? offset.distance / patch->sigma : 0.0, 1e-9)
        << i;
  }
}

TEST(SurfaceScore, HintsChangeNothing)
{
  const SphereCase c;
  const SurfaceScorer scorer(c.source, c.model);
  PatchHints hints;
  SurfaceScores hinted;
  Random random(63, 0);
  for (int repeat = 0; repeat < 5; ++repeat) {
    const Isometry3d pose =
        movedBy(0.03 * random.normal6(), Vector3d::Zero(), Isometry3d::Identity());
    const SurfaceScores fresh = test::scoresAt(scorer, pose, Vector3d::Zero(), 1.2);
    scorer.evaluate(pose, Vector3d::Zero(), 1.2, hints, hinted);
    EXPECT_EQ(hinted.total, fresh.total);
    EXPECT_EQ(hinted.residuals, fresh.residuals);
    EXPECT_EQ(hinted.scores, fresh.scores);
    EXPECT_EQ(hinted.has_patch, fresh.has_patch);
  }
}

TEST(SurfaceScore, BatchesAddUp)
{
  const SphereCase c;
  const SurfaceScorer scorer(c.source, c.model);
  const Isometry3d pose = Isometry3d::Identity();
  const Vector3d centre(0.1, 0.0, -0.1);
  const double tau = 0.6;
  const SurfaceScores scores = test::scoresAt(scorer, pose, centre, tau);
  ASSERT_LT(scores.num_active, c.source.cols());

  std::vector<std::size_t> all(static_cast<std::size_t>(c.source.cols()));
  std::iota(all.begin(), all.end(), std::size_t(0));
  PatchHints hints;
  Vector6d total;
  EXPECT_EQ(scorer.batchScore(pose, centre, tau, all, hints, total),
            std::count(scores.has_patch.begin(), scores.has_patch.end(), 1));
  EXPECT_LT((total - scores.total).norm(), 1e-12 * scores.scores.norm());

  scorer.batchScore(pose, centre, tau, {5, 9, 5}, hints, total);
  EXPECT_LT((total - 2.0 * scores.scores.col(5) - scores.scores.col(9)).norm(),
            1e-12 * scores.scores.norm());
}

TEST(SurfaceScore, IsZeroWithoutPatches)
{
  Random random(64, 0);
  const Matrix3Xd source = test::randomPoints(random, 10);
  for (const Index num_target_points : {0, 1, 7}) {
    const SurfaceModel model(test::randomPoints(random, num_target_points));
    const SurfaceScores scores = test::scoresAt(
        SurfaceScorer(source, model), Isometry3d::Identity(), Vector3d::Zero(), 1.0);
    EXPECT_EQ(scores.total, Vector6d::Zero());
    EXPECT_EQ(scores.information, Matrix6d::Zero());
    EXPECT_EQ(scores.num_active, 0);
    EXPECT_EQ(meanCappedResidual(scores), 5.0);
    EXPECT_EQ(costOf(scores), 5.0);
    EXPECT_EQ(residualScale(scores), 1.0);
  }
}

TEST(SurfaceScore, ScaleAndCostOfResiduals)
{
  SurfaceScores scores{};
  scores.residuals.resize(6);
  scores.residuals << 1.0, -2.0, 0.5, 100.0, -7.0, 0.1;
  scores.has_patch = {1, 1, 1, 0, 1, 1};
  scores.num_source_points = 6;
  // Magnitudes 0.1, 0.5, 1, 2, 7; the fourth point has no patch and costs 5.
  EXPECT_DOUBLE_EQ(residualScale(scores), 1.4826);
  EXPECT_DOUBLE_EQ(meanCappedResidual(scores), (1.0 + 2.0 + 0.5 + 5.0 + 5.0 + 0.1) / 6);
  // Off the continuation it costs more than the mean of the others, on it as much.
  scores.off_continuation.setZero(6);
  scores.off_continuation[3] = 0.9;
  EXPECT_DOUBLE_EQ(costOf(scores), (8.6 + 4.5) / 6);
  scores.off_continuation[3] = 0.1;
  EXPECT_DOUBLE_EQ(costOf(scores), (8.6 + 8.6 / 5) / 6);
  const Eigen::VectorXd capped = cappedResiduals(scores);
  EXPECT_TRUE(std::isnan(capped[3]));
  EXPECT_EQ(capped[1], 2.0);
  EXPECT_EQ(capped[4], 5.0);
  scores.residuals *= 0.1;
  EXPECT_DOUBLE_EQ(residualScale(scores), 0.3);
}

TEST(SurfaceScore, IsTheSameFarFromTheOrigin)
{
  const SphereCase c;
  const Vector3d far(512000.0, 5400000.0, 128.0);
  const auto scoresOn = [&](const Matrix3Xd& target, const Vector3d& shift) {
    const SurfaceModel model(target);
    const Isometry3d pose(Eigen::Translation3d(Vector3d(0.001, -0.001, 0.002) + shift));
    return test::scoresAt(
        SurfaceScorer(c.source, model), pose, pose.translation(), 1.0);
  };
  const SurfaceScores near_scores = scoresOn(c.source, Vector3d::Zero());
  const SurfaceScores far_scores = scoresOn(c.source.colwise() + far, far);
  // Coordinates there are multiples of 1e-9 m, of a noise of 2e-3 m; a hundred times
  // that for what quadrics make of it.
  EXPECT_EQ(far_scores.has_patch, near_scores.has_patch);
  EXPECT_LT((far_scores.residuals - near_scores.residuals).lpNorm<Eigen::Infinity>(),
            1e-4);
}

} // namespace
} // namespace bayesian_icp
