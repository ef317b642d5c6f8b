// Further modes of preset `calibrated`: a cube, whose sides look alike, scanned from
// all sides.
#include "calibrated/calibrated_stand_in.h"
#include "calibrated/calibration_test_support.h"
#include "calibrated/modes/calibrated_modes.h"
#include "calibrated/modes/mode_weights.h"
#include "calibrated/modes/robust_mode.h"
#include "support/test_support.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace bayesian_icp {
namespace {

constexpr double quarter_turn = 1.57079632679489662;

/** Points all over a body that stands upright about the origin, in random order. */
template <typename Surface>
Eigen::Matrix3Xd
sampled(const Surface& surface, Eigen::Index num_points, std::uint64_t seed)
{
  constexpr double noise = 0.0005;
  Random random(seed, 0);
  Eigen::Matrix3Xd points(3, num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const Eigen::Vector3d point = surface(random);
    points.col(i) = point + noise * random.normal6().head<3>();
  }
  return points;
}

/** Sides and top of a cube of 0.1 m. */
Eigen::Vector3d
onCube(Random& random)
{
  const double half = 0.05;
  const double x = half * (2.0 * random.uniform() - 1.0),
               y = half * (2.0 * random.uniform() - 1.0);
  const std::size_t face = random.index(5);
  if (face == 4)
    return {x, y, half};
  const Eigen::AngleAxisd turn(static_cast<double>(face) * quarter_turn,
                               Eigen::Vector3d::UnitZ());
  return turn * Eigen::Vector3d(half, x, y);
}

/** Side and top of a can of 0.1 m. */
Eigen::Vector3d
onCan(Random& random)
{
  const double radius = 0.035, half = 0.05, height = 2.0 * random.uniform() - 1.0;
  const Eigen::AngleAxisd turn(4.0 * quarter_turn * random.uniform(),
                               Eigen::Vector3d::UnitZ());
  if (random.index(4) == 0)
    return turn * Eigen::Vector3d(radius * std::sqrt(random.uniform()), 0.0, half);
  return turn * Eigen::Vector3d(radius, 0.0, half * height);
}

/** A can with a handle: a plate that stands out from its side. */
Eigen::Vector3d
onMug(Random& random)
{
  if (random.index(20) > 0)
    return onCan(random);
  return {0.035 + 0.02 * random.uniform(), 0.0, 0.02 * (random.uniform() - 0.5)};
}

constexpr double step_run = 0.28, step_rise = 0.17;

/** Six stairs between two walls, up to a wall. */
Eigen::Vector3d
onStairs(Random& random)
{
  const double across = random.uniform() - 0.5, along = random.uniform();
  const auto step = static_cast<double>(random.index(6));
  switch (random.index(4)) {
  case 0:
    return {step_run * (step + along), across, step_rise * step};
  case 1:
    return {step_run * step, across, step_rise * (step - along)};
  case 2:
    return {6.0 * step_run * along, across < 0.0 ? -0.5 : 0.5, across};
  default:
    return {6.0 * step_run, across, step_rise * (5.0 + 4.0 * along)};
  }
}

constexpr double pillar_distance = 0.5;

/** Floor and walls of a corridor along x, and pillars beside it, as far as \p end. */
auto
onPillarsUpTo(double end)
{
  return [end](Random& random) -> Eigen::Vector3d {
    const double along = 2.0 * random.uniform() - 1.0, across = random.uniform();
    const auto num_pillars = static_cast<std::size_t>(2.0 * end / pillar_distance);
    switch (random.index(4)) {
    case 0:
      return {end * along, 2.0 * across - 1.0, 0.0};
    case 1:
      return {end * along, random.index(2) == 0 ? -1.0 : 1.0, across};
    default:
      const Eigen::AngleAxisd turn(2.0 * quarter_turn * along,
                                   Eigen::Vector3d::UnitZ());
      const double x =
          pillar_distance * (static_cast<double>(random.index(num_pillars)) + 0.5) -
          end;
      return Eigen::Vector3d(x, 0.8, across) + turn * Eigen::Vector3d(0.08, 0.0, 0.0);
    }
  };
}

struct FacePoint {
  Eigen::Vector3d point, normal;
};

/** All faces of five boards that make a box of 0.4 x 0.3 x 0.18 m without a lid. */
FacePoint
onOpenBox(Random& random)
{
  constexpr double thickness = 0.01;
  struct Board {
    Eigen::Vector3d low, high;
  };
  const std::array<Board, 5> boards = {
      {{{-0.2, -0.15, -thickness}, {0.2, 0.15, 0.0}},
       {{-0.2, -0.15, 0.0}, {0.2, -0.15 + thickness, 0.17}},
       {{-0.2, 0.15 - thickness, 0.0}, {0.2, 0.15, 0.17}},
       {{-0.2, -0.15, 0.0}, {-0.2 + thickness, 0.15, 0.17}},
       {{0.2 - thickness, -0.15, 0.0}, {0.2, 0.15, 0.17}}}};
  for (;;) {
    const Board& board = boards[random.index(boards.size())];
    const Eigen::Vector3d size = board.high - board.low;
    const auto axis = static_cast<Eigen::Index>(random.index(3));
    // Each face is as likely as it is large.
    if (random.uniform() > size.prod() / size[axis] / 0.12)
      continue;
    FacePoint result;
    for (Eigen::Index k = 0; k < 3; ++k)
      result.point[k] = board.low[k] + random.uniform() * size[k];
    const bool is_high = random.index(2) == 1;
    result.point[axis] = is_high ? board.high[axis] : board.low[axis];
    result.normal = (is_high ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
    return result;
  }
}

/** The faces that look to the sensor. */
Eigen::Vector3d
onVisibleOpenBox(Random& random)
{
  const Eigen::Vector3d sensor(0.8, 0.6, 0.7);
  for (;;) {
    const FacePoint on = onOpenBox(random);
    if (on.normal.dot(sensor - on.point) > 0.0)
      return on.point;
  }
}

struct Clouds {
  Eigen::Matrix3Xd source, target;
  Eigen::Isometry3d truth;
};

template <typename Surface>
Clouds
cloudsOf(const Surface& surface, double true_yaw)
{
  const Vector6d truth(0.01, -0.02, 0.01, 0.03, -0.02, true_yaw);
  Clouds clouds;
  clouds.truth = isometryOf(truth);
  clouds.target = sampled(surface, 12000, 1);
  clouds.source = clouds.truth.inverse() * sampled(surface, 2000, 2);
  return clouds;
}

Vector6d
deviationsWith(double yaw_sd)
{
  return {0.03, 0.03, 0.03, 0.06, 0.06, yaw_sd};
}

test::Problem
problemOf(const Clouds& clouds, double yaw_sd)
{
  return {clouds.source, clouds.target, deviationsWith(yaw_sd)};
}

/** Squared distance of the true pose from the mean, in standard deviations. */
double
squaredErrorOf(const CalibratedEstimate& e, const Eigen::Isometry3d& truth)
{
  return test::squaredError(twistBetween(e.mode, truth, e.centre) - e.mean,
                            e.covariance);
}

/** An estimate that was started off the truth, and stays there.
 * \param[in] slip by which the start is off [m] */
CalibratedEstimate
estimateAfterSlip(const test::Problem& problem,
                  const Clouds& clouds,
                  const Eigen::Vector3d& slip)
{
  const Eigen::Isometry3d slipped = Eigen::Translation3d(slip) * clouds.truth;
  const CalibratedEstimate estimate = problem.estimate({}, &slipped);
  EXPECT_GT(squaredErrorOf(estimate, clouds.truth), 1000.0);
  return estimate;
}

/** Expects that the truth is within the heaviest mode. */
void
expectFound(const std::vector<CalibratedMode>& modes, const Clouds& clouds)
{
  ASSERT_FALSE(modes.empty());
  EXPECT_LT(squaredErrorOf(modes.front().estimate, clouds.truth), test::chi_square_999);
}

/** A fit whose points have these residuals; the last \p num_unseen have no patch. */
RobustFit
fitWith(double residual, Eigen::Index num_unseen)
{
  RobustFit fit;
  fit.residuals.setConstant(100, residual);
  fit.residuals.tail(num_unseen).setConstant(std::nan(""));
  fit.cost = (residual * static_cast<double>(100 - num_unseen) +
              5.0 * static_cast<double>(num_unseen)) /
             100.0;
  return fit;
}

TEST(RelativeCost, OverlapDoesNotCountWherePointsTellFitsApart)
{
  const RobustFit right = fitWith(1.0, 40), overlapping = fitWith(1.25, 0);
  EXPECT_LT(overlapping.cost, right.cost);
  EXPECT_DOUBLE_EQ(relativeCost(overlapping, right), 1.25);
  EXPECT_DOUBLE_EQ(relativeCost(right, overlapping), 0.8);
}

TEST(RelativeCost, OverlapCountsWherePointsDoNotTell)
{
  // The 60 common points differ by 0.5 up and down: by 3 in sum, with a standard
  // deviation of 0.5 sqrt(60) = 3.9.
  RobustFit seen = fitWith(1.0, 0);
  const RobustFit unseen = fitWith(1.0, 40);
  for (Eigen::Index i = 0; i < 60; ++i)
    seen.residuals[i] += i < 33 ? 0.5 : -0.5;
  EXPECT_DOUBLE_EQ(relativeCost(unseen, seen), unseen.cost / seen.cost);
  // Clouds that do not meet have no common points.
  const RobustFit nowhere = fitWith(1.0, 100);
  EXPECT_DOUBLE_EQ(relativeCost(nowhere, seen), 5.0 / seen.cost);
}

TEST(RelativeCost, AFitOfFewerPointsMakesNoOtherClearlyWorse)
{
  const RobustFit overlapping = fitWith(1.2, 0), nowhere = fitWith(1.0, 100);
  EXPECT_TRUE(isClearlyWorse(overlapping, fitWith(0.8, 5), 0.2));
  EXPECT_TRUE(isClearlyWorse(nowhere, overlapping, 0.2));
  EXPECT_FALSE(isClearlyWorse(overlapping, fitWith(1.1, 0), 0.2));
  // Its 40 points fit better, and cost 3.3 with the others.
  EXPECT_FALSE(isClearlyWorse(overlapping, fitWith(0.8, 60), 0.2));
}

TEST(RobustFit, StaysWhereItIsHeldAndFitsTheRest)
{
  const Clouds clouds = cloudsOf(onMug, 0.0);
  const test::Problem problem = problemOf(clouds, 0.5);
  Vector6d wrong = Vector6d::Zero();
  wrong[2] = 0.01; // Along the axis, which the ends would find.
  const Eigen::Vector3d centre = clouds.truth * problem.scorer.centroid();
  const Eigen::Isometry3d start = movedBy(wrong, centre, clouds.truth);
  RobustFitOptions options;
  options.tolerance = 1e-6;
  const auto offTruth = [&] {
    const RobustFit fit = fitRobustly(problem.scorer, problem.prior, start, options);
    return Vector6d(twistBetween(clouds.truth, fit.pose, centre));
  };
  const Vector6d free = offTruth();
  EXPECT_LT(std::abs(free[2]), 0.001);
  constexpr double tolerance = 1e-5;
  options.hold(2, 2) = 1.0 / (tolerance * tolerance);
  const Vector6d held = offTruth();
  EXPECT_NEAR(held[2], wrong[2], 10 * tolerance);
  EXPECT_LT(held.head<2>().norm(), 0.002);
}

TEST(CalibratedModes, OfACubeAreAQuarterTurnApart)
{
  const Clouds clouds = cloudsOf(onCube, 1.3);
  const test::Problem problem = problemOf(clouds, 1.0);
  const CalibratedEstimate first = problem.estimate();
  ASSERT_TRUE(mayHaveSeveralModes(problem.scorer, problem.prior, first));
  const long num_queries_of_first = problem.scorer.numQueries();
  const std::vector<CalibratedMode> modes =
      findModes(problem.scorer, problem.prior, first);
  const long num_queries = problem.scorer.numQueries() - num_queries_of_first;
  ASSERT_GE(modes.size(), 3u);
  double least_distance = 1e9, last_weight = 1e9;
  for (const auto& mode : modes) {
    EXPECT_LE(mode.log_weight, last_weight);
    last_weight = mode.log_weight;
    const Vector6d apart = twistBetween(first.mode, mode.estimate.mode, first.centre);
    const double turns = apart.tail<3>().norm() / quarter_turn;
    EXPECT_NEAR(turns, std::round(turns), 0.05);
    least_distance =
        std::min(least_distance, squaredErrorOf(mode.estimate, clouds.truth));
  }
  // 16 starts and 15 hops of 300 points and at most 21 evaluations, half of the points
  // 20 more times, and an estimate for each other mode.
  EXPECT_LE(num_queries,
            (16 + 15) * 300 * (21 + 10) + 300 +
                static_cast<long>(modes.size() - 1) * num_queries_of_first);
  EXPECT_LT(least_distance, test::chi_square_999);

  const ChainSet set = sampleCalibrated(scoresOf(problem.scorer),
                                        problem.prior,
                                        modes,
                                        CalibratedOptions(),
                                        ChainOptions());
  ASSERT_GE(set.modes.size(), 2u);
  ASSERT_EQ(set.chains.size(), 4 * set.modes.size());
  double sum = 0.0;
  for (const auto& mode : modes)
    sum += std::exp(mode.log_weight);
  for (std::size_t m = 0; m < set.modes.size(); ++m) {
    Eigen::Index num_draws = 0;
    for (const int chain : set.modes[m].members)
      num_draws += set.chains[static_cast<std::size_t>(chain)].draws.rows();
    EXPECT_NEAR(static_cast<double>(num_draws),
                2000.0 * std::exp(modes[m].log_weight) / sum,
                0.51);
  }
}

TEST(CalibratedModes, ThereIsOneOfACanHoweverItTurns)
{
  const Clouds clouds = cloudsOf(onCan, 1.3);
  const test::Problem problem = problemOf(clouds, 1.0);
  const Prior narrow(
      Vector6d::Zero(), deviationsWith(0.19).cwiseAbs2(), problem.scorer.centroid());
  const CalibratedEstimate first = problem.estimate();
  EXPECT_EQ(findModes(problem.scorer, problem.prior, first).size(), 1u);
  EXPECT_FALSE(mayHaveSeveralModes(problem.scorer, narrow, first));
}

TEST(CalibratedModes, AHandleOutweighsAFreeYaw)
{
  const Clouds clouds = cloudsOf(onMug, 0.3);
  const test::Problem problem = problemOf(clouds, 0.35);
  const CalibratedEstimate first = problem.estimate();
  std::size_t num_modes = 0;
  ModeSearchOptions options;
  for (options.seed = 1; options.seed <= 4; ++options.seed) {
    const std::vector<CalibratedMode> modes =
        findModes(problem.scorer, problem.prior, first, options);
    num_modes = std::max(num_modes, modes.size());
    EXPECT_GT(modes.front().estimate.keep.minCoeff(), 0.0);
    expectFound(modes, clouds);
  }
  EXPECT_GT(num_modes, 1u);
}

TEST(CalibratedModes, AFirstEstimateThatWentAstrayHidesNone)
{
  const Clouds clouds = cloudsOf(onMug, 0.3);
  const test::Problem problem = problemOf(clouds, 0.35);
  // It leaves all motions to the prior, so each pose may be the same mode.
  CalibratedEstimate astray = problem.estimate();
  astray.mode.translation().x() += 0.3;
  astray.keep.setZero();
  expectFound(findModes(problem.scorer, problem.prior, astray), clouds);
}

TEST(CalibratedModes, AFirstEstimateThatFitsBadlyHidesNoBetterOne)
{
  const Clouds clouds = cloudsOf(onMug, 0.3);
  const test::Problem problem = problemOf(clouds, 0.35);
  const CalibratedEstimate right = problem.estimate();
  // Deviations that are so large that they reach to the right pose.
  CalibratedEstimate wide = right;
  wide.mode.translation().x() += 0.02;
  wide.information.setIdentity();
  wide.information.diagonal().array() /= 0.02 * 0.02;
  wide.scores.total.setZero();
  const std::vector<CalibratedMode> modes =
      findModes(problem.scorer, problem.prior, wide);
  EXPECT_TRUE(std::any_of(modes.begin(), modes.end(), [&](const auto& mode) {
    return mode.estimate.mode.isApprox(right.mode, 1e-3);
  }));
}

TEST(CalibratedModes, AHopFindsABoxWhoseBoardsLieOnTheirOtherFaces)
{
  Clouds clouds = cloudsOf(onVisibleOpenBox, 0.03);
  clouds.target =
      sampled([](Random& random) { return onOpenBox(random).point; }, 20000, 3);
  const test::Problem problem = problemOf(clouds, 0.06);
  for (const Eigen::Vector3d& slip :
       {Eigen::Vector3d(-0.01, 0.0, 0.0), Eigen::Vector3d(-0.01, -0.01, 0.0)}) {
    const CalibratedEstimate first = estimateAfterSlip(problem, clouds, slip);
    ASSERT_FALSE(mayHaveSeveralModes(problem.scorer, problem.prior, first));
    expectFound(findModes(problem.scorer, problem.prior, first), clouds);
  }
}

TEST(CalibratedModes, AScanLeadsWhereItsModelIsTheSource)
{
  // The faces of the model that the scan cannot see meet the wrong side of its boards.
  Clouds clouds = cloudsOf(onVisibleOpenBox, 0.03);
  clouds.source =
      clouds.truth.inverse() *
      sampled([](Random& random) { return onOpenBox(random).point; }, 20000, 3);
  test::Problem problem = problemOf(clouds, 0.06);
  const SurfaceModel of_source(clouds.source);
  problem.scorer.addTargetPoints(clouds.target.leftCols(2000), of_source);
  const std::vector<CalibratedMode> modes =
      findModes(problem.scorer,
                problem.prior,
                estimateAfterSlip(problem, clouds, {0.01, 0.01, 0.0}));
  expectFound(modes, clouds);
  EXPECT_EQ(significantModes(modes).size(), 1u);
}

TEST(CalibratedModes, AHopFindsStairsThatSlippedByAStep)
{
  const Clouds clouds = cloudsOf(onStairs, 0.3);
  const test::Problem problem(clouds.source, clouds.target, Vector6d::Constant(0.6));
  const CalibratedEstimate first =
      estimateAfterSlip(problem, clouds, {step_run, 0.0, step_rise});
  ModeSearchOptions only_hops;
  only_hops.num_starts = 0;
  expectFound(findModes(problem.scorer, problem.prior, first, only_hops), clouds);
}

TEST(CalibratedModes, WithinTheRegionOfAWiderOneAreNotModesOfTheirOwn)
{
  CalibratedMode wide = {test::StandIn({}).estimate, 0.0};
  wide.estimate.scores.total.setZero();
  const Eigen::LLT<Matrix6d> precision(wide.estimate.information);
  // A hundred times as sure, so that the wide mode is far outside of its region.
  const auto narrowAt = [&](double squared_distance) {
    CalibratedMode narrow = wide;
    CalibratedEstimate& e = narrow.estimate;
    const Vector6d xi = precision.matrixU().solve(
        Vector6d(std::sqrt(squared_distance / 6.0) * Vector6d::Ones()));
    e.mode = Eigen::Translation3d(e.centre) * Eigen::Isometry3d(expSE3(xi)) *
             Eigen::Translation3d(-e.centre) * e.mode;
    e.curvature *= 100.0;
    e.score_covariance *= 100.0;
    e.information *= 100.0;
    return narrow;
  };
  const auto informationsOf = [](const std::vector<CalibratedMode>& modes) {
    std::vector<double> informations;
    for (const CalibratedMode& mode : modes)
      informations.push_back(mode.estimate.information(0, 0));
    return informations;
  };
  const double of_wide = wide.estimate.information(0, 0);
  using List = std::vector<double>;
  // The 99 % quantile of the chi-square distribution with 6 degrees of freedom is 16.8.
  for (const double near : {1.0, 15.5}) {
    EXPECT_EQ(informationsOf(separateModes({wide, narrowAt(near)})), List{of_wide});
    EXPECT_EQ(informationsOf(separateModes({narrowAt(near), wide})), List{of_wide});
  }
  EXPECT_EQ(separateModes({wide, narrowAt(18.0)}).size(), 2u);
  EXPECT_EQ(separateModes({narrowAt(18.0), wide, narrowAt(40.0)}).size(), 3u);
  // An estimate that is not finite holds none.
  CalibratedMode broken = wide;
  broken.estimate.information.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(separateModes({broken, narrowAt(1.0)}).size(), 2u);
  // Of two that are within each other's region the first one, which is the heavier.
  CalibratedMode lighter = wide;
  lighter.estimate.information *= 1.1;
  EXPECT_EQ(informationsOf(separateModes({wide, lighter})), List{of_wide});
}

TEST(CalibratedModes, ASlideFindsTheOtherPlacesAmongPillars)
{
  Clouds clouds = cloudsOf(onPillarsUpTo(1.5), 0.03);
  clouds.target = sampled(onPillarsUpTo(4.0), 20000, 3);
  Vector6d deviations;
  deviations << Eigen::Vector3d::Constant(0.35), Eigen::Vector3d::Constant(0.1);
  const test::Problem problem(clouds.source, clouds.target, deviations);
  for (const int num_pillars : {-1, 1}) {
    const CalibratedEstimate first =
        estimateAfterSlip(problem, clouds, {num_pillars * pillar_distance, 0.0, 0.0});
    ASSERT_FALSE(mayHaveSeveralModes(problem.scorer, problem.prior, first));
    const std::vector<CalibratedMode> modes =
        findModes(problem.scorer, problem.prior, first);
    EXPECT_TRUE(std::any_of(modes.begin(), modes.end(), [&](const auto& mode) {
      return squaredErrorOf(mode.estimate, clouds.truth) < test::chi_square_999;
    }));
  }
}

class ModeWeights : public testing::Test {
protected:
  /** How much heavier a mode is than the same one where \p num_missing points do not
   * meet the target.
   * \param[in] region_of_cloud of weighModes()
   * \param[in] off_continuation of these points */
  double
  weightOfPoints(int num_missing, double region_of_cloud, double off_continuation) const
  {
    std::vector<CalibratedMode> modes(2, {estimate_, 0.0});
    modes[1].estimate.cost += 1e-9;
    for (auto& mode : modes) {
      auto& scores = mode.estimate.scores;
      scores.residuals.setZero();
      std::fill(scores.has_patch.begin(), scores.has_patch.end(), true);
    }
    auto& scores = modes[1].estimate.scores;
    std::fill(scores.has_patch.begin(), scores.has_patch.begin() + num_missing, false);
    scores.off_continuation.head(num_missing).setConstant(off_continuation);
    weighModes(problem_.prior, region_of_cloud, {}, modes);
    return modes[0].log_weight - modes[1].log_weight;
  }

  const test::Problem problem_ = problemOf(cloudsOf(onCube, 0.3), 0.35);
  const CalibratedEstimate estimate_ = problem_.estimate();
};

TEST_F(ModeWeights, RegionsThatMeetNoTargetCountAsFarAsTheyAreMany)
{
  // n points in regions of R have an energy of n e with a variance of n R e^2, of which
  // n e - 4 R e counts.
  constexpr double region_parts = 40.0;
  const double region =
      0.5 * static_cast<double>(estimate_.scores.residuals.size()) / region_parts;
  ASSERT_GT(region, estimate_.kappa_inf);
  const auto weightOf = [&](double num_regions) {
    return weightOfPoints(
        static_cast<int>(num_regions * region), 1.0 / region_parts, 0.0);
  };
  EXPECT_EQ(weightOf(2.0), 0.0);
  EXPECT_EQ(weightOf(3.99), 0.0);
  EXPECT_NEAR(weightOf(4.0), 0.0, 1e-9);
  EXPECT_GT(weightOf(8.0), 0.0);
  EXPECT_NEAR(weightOf(16.0) / weightOf(8.0), 3.0, 1e-9);
}

TEST_F(ModeWeights, PointsThatCouldNotBeSeenAndSlightMisfitsAreNoEvidence)
{
  constexpr int num_missing = 200;
  const Eigen::Index num_points = estimate_.scores.residuals.size();
  const auto weightOf = [&](double misfit, bool are_seen) {
    std::vector<CalibratedMode> modes(2, {estimate_, 0.0});
    std::vector<std::vector<char>> unseen(2, std::vector<char>(num_points, false));
    for (auto& mode : modes) {
      auto& scores = mode.estimate.scores;
      scores.residuals.setConstant(0.1);
      std::fill(scores.has_patch.begin(), scores.has_patch.end(), true);
      std::fill(scores.active.begin(), scores.active.end(), true);
      scores.num_source_points = num_points;
      scores.num_active = scores.num_active_of_source = static_cast<int>(num_points);
    }
    modes[1].estimate.cost += 1e-9;
    auto& scores = modes[1].estimate.scores;
    // Energies of small residuals are as their squares.
    scores.residuals *= std::sqrt(misfit);
    for (int i = 0; i < num_missing; ++i) {
      scores.has_patch[i] = scores.active[i] = false;
      scores.off_continuation[i] = 1.0;
      unseen[1][i] = !are_seen;
    }
    scores.num_active -= num_missing;
    scores.num_active_of_source -= num_missing;
    weighModes(problem_.prior, 0.0, unseen, modes);
    return modes[0].log_weight - modes[1].log_weight;
  };
  EXPECT_NEAR(weightOf(1.0, false), 0.0, 1e-9);
  EXPECT_NEAR(weightOf(1.14, false), 0.0, 1e-9);
  EXPECT_GT(weightOf(2.0, false), 0.1);
  EXPECT_GT(weightOf(1.0, true), 10.0);
}

TEST_F(ModeWeights, PointsOfAModelThatAScanCannotMeetAreNoEvidence)
{
  // Half of the points are the scan's. In one of the modes, 200 of the others miss.
  const Eigen::Index num_points = estimate_.scores.residuals.size();
  const int half = static_cast<int>(num_points / 2), num_missing = 200;
  const auto weightOf = [&](double fitting_part_of_scan, double fitting_part_of_model) {
    std::vector<CalibratedMode> modes(2, {estimate_, 0.0});
    for (auto& mode : modes) {
      auto& scores = mode.estimate.scores;
      scores.residuals.setZero();
      std::fill(scores.has_patch.begin(), scores.has_patch.end(), true);
      scores.num_source_points = half;
      scores.num_active_of_source =
          static_cast<int>(std::lround(fitting_part_of_scan * half));
      scores.num_active = scores.num_active_of_source +
                          static_cast<int>(std::lround(fitting_part_of_model * half));
    }
    modes[1].estimate.cost += 1e-9;
    auto& scores = modes[1].estimate.scores;
    std::fill(scores.has_patch.end() - num_missing, scores.has_patch.end(), false);
    scores.off_continuation.tail(num_missing).setOnes();
    weighModes(problem_.prior, 0.0, {}, modes);
    return modes[0].log_weight - modes[1].log_weight;
  };
  const double of_scans = weightOf(0.95, 0.95);
  EXPECT_GT(of_scans, 10.0);
  EXPECT_NEAR(weightOf(0.96, 0.72), 0.5 * of_scans, 0.01 * of_scans);
  EXPECT_EQ(weightOf(0.95, 0.45), 0.0);
  EXPECT_EQ(weightOf(0.95, 0.1), 0.0);
  // Half of the scan meets nothing, so it is not part of the model.
  EXPECT_EQ(weightOf(0.5, 0.1), of_scans);
}

TEST_F(ModeWeights, OverlapOnASurfaceThatGoesOnIsNoEvidence)
{
  const auto weightOf = [&](double off_continuation) {
    return weightOfPoints(1000, 0.0, off_continuation);
  };
  EXPECT_EQ(weightOf(0.0), 0.0);
  // n points of an energy e count n e - 4 kappa e.
  EXPECT_GT(weightOf(1.0), 0.0);
  EXPECT_NEAR(weightOf(0.5) / weightOf(1.0), 0.5, 1e-9);
}

TEST(CalibratedModes, ThereIsOneAlsoOfCloudsThatDoNotMeet)
{
  Clouds clouds = cloudsOf(onCube, 0.0);
  clouds.source.row(0).array() += 50.0;
  const test::Problem problem = problemOf(clouds, 0.35);
  EXPECT_EQ(calibratedModes(problem.scorer, problem.prior).size(), 1u);
}

PosteriorEstimate
estimateFrom(const Clouds& clouds, double yaw_sd)
{
  Options options;
  options.preset = Preset::Calibrated;
  options.prior.variance = deviationsWith(yaw_sd).cwiseAbs2();
  options.prior.frame = PriorFrame::SourceCentroid;
  return estimatePosterior(clouds.source, clouds.target, Vector6d::Zero(), options);
}

TEST(CalibratedModes, OfACubeAreInTheSummary)
{
  const PosteriorEstimate estimate = estimateFrom(cloudsOf(onCube, 1.3), 1.0);
  const Summary& summary = estimate.summary;
  EXPECT_EQ(summary.status, Status::SeveralModes) << summary.message;
  EXPECT_NE(summary.message.find("is of the heaviest"), std::string::npos);
  EXPECT_EQ(estimate.samples.rows(), summary.num_draws);
  ASSERT_GE(summary.modes.size(), 2u);
  double sum = 0.0, nearest_turn = 1e9;
  for (const Mode& mode : summary.modes) {
    EXPECT_GE(mode.weight, 0.02);
    sum += mode.weight;
    nearest_turn = std::min(nearest_turn, std::abs(wrapAngle(mode.mean[5] - 1.3)));
    std::vector<Chain> chains;
    for (const int index : mode.chains)
      chains.push_back(estimate.chains[static_cast<std::size_t>(index)]);
    const PoseMatrix draws = pooledDraws(chains);
    const PoseEstimate chosen(summary, mode);
    EXPECT_EQ(chosen.status, Status::Doubtful);
    EXPECT_EQ(chosen.mean, meanPose(draws));
    for (const auto convention : covariance_conventions)
      EXPECT_EQ(chosen.covariance(convention),
                covarianceAbout(chosen.mean, draws, convention));
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_LT(nearest_turn, 0.05 * quarter_turn);
  // The report's centre is where the source's centroid is in the first mode.
  const Eigen::Vector3d centroid = cloudsOf(onCube, 1.3).source.rowwise().mean();
  EXPECT_LT((isometryOf(summary.modes[0].mean) * centroid - summary.data.centre).norm(),
            0.001);
}

TEST(CalibratedModes, TheYawOfACanIsThatOfThePrior)
{
  const PosteriorEstimate estimate = estimateFrom(cloudsOf(onCan, 0.7), 1.0);
  const Summary& summary = estimate.summary;
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
  EXPECT_TRUE(summary.modes.empty());
  int num_prior_only = 0;
  for (const DataDirection& direction : summary.data.directions)
    if (direction.observability == Observability::PriorOnly) {
      ++num_prior_only;
      EXPECT_GT(std::abs(direction.twist.tail<3>().normalized().z()), 0.99);
    }
  EXPECT_EQ(num_prior_only, 1);
  // Of a von Mises variate with kappa = 1: E cos = I1(1) / I0(1), and E cos 2 =
  // I2(1) / I0(1) gives its variance.
  constexpr double mean = 0.446390, sd = 0.595;
  const double ess = summary.coordinates[5].bulk_ess;
  EXPECT_NEAR(
      estimate.samples.col(5).array().cos().mean(), mean, 4.0 * sd / std::sqrt(ess));
}

} // namespace
} // namespace bayesian_icp
