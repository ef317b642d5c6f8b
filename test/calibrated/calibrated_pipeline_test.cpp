// Preset `calibrated` from end to end: what it finds, and what it says when it cannot.
#include "support/test_support.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

namespace bayesian_icp {
namespace {

constexpr double noise = 0.003;

Eigen::Matrix3Xd
surface(std::uint64_t seed, Eigen::Index num_points)
{
  return test::wavySurface(seed, num_points, 0.05, noise);
}

/** A surface scanned twice. */
struct Scans {
  Vector6d truth{0.01, -0.02, 0.015, 0.02, -0.03, 0.025};
  Eigen::Matrix3Xd source = surface(91, 1500);
  Eigen::Matrix3Xd target = test::moved(truth, surface(92, 6000));
};

Options
calibratedOptions()
{
  Options options;
  options.preset = Preset::Calibrated;
  options.prior.variance.setConstant(0.01);
  options.prior.frame = PriorFrame::SourceCentroid;
  return options;
}

PosteriorEstimate
estimateFrom(const Scans& scans, const Options& options = calibratedOptions())
{
  return estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
}

TEST(Calibrated, APriorThatDoublePrecisionCannotHoldIsRefused)
{
  // The fixed origin is 2 m from the cloud, which turns about it.
  const Eigen::Vector3d aside(2.0, 1.0, 0.5);
  Scans scans;
  scans.source.colwise() += aside;
  const Eigen::Matrix3Xd target = surface(92, 6000).colwise() + aside;
  scans.target = test::moved({0.0, 0.0, 0.0, 0.02, -0.03, 0.025}, target);
  Options options = calibratedOptions();
  options.prior.frame = PriorFrame::Origin;
  for (const double variance : {1e-12, 1e-16, 1e-20}) {
    options.prior.variance.head<3>().setConstant(variance);
    const Summary summary = estimateFrom(scans, options).summary;
    if (variance < 1e-14) {
      EXPECT_EQ(summary.status, Status::InvalidOptions) << variance;
      EXPECT_NE(summary.message.find("double precision"), std::string::npos);
      continue;
    }
    EXPECT_EQ(summary.status, Status::Ok) << summary.message;
    EXPECT_TRUE(summary.covariance(CovarianceConvention::R3xSO3).allFinite());
  }
  // A robot in its plane, whose sensor is tilted.
  options.prior.variance << 0.01, 0.01, 1e-24, 1e-24, 1e-24, 0.01;
  const Vector6d tilted{0.0, 0.0, 0.0, 0.1, 0.3, 0.2};
  scans.target = test::moved(tilted, target);
  const Summary summary =
      estimatePosterior(scans.source, scans.target, tilted, options).summary;
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
}

TEST(Calibrated, APreparedCloudIsForManySourcesPresetsAndThreads)
{
  const Scans scans;
  Scans other_scans;
  other_scans.source = surface(93, 1400);
  Options exact = calibratedOptions();
  exact.preset = Preset::Exact;
  exact.chains.num_draws = 40;
  const PoseMatrix expected = estimateFrom(scans).samples;
  const PoseMatrix of_other = estimateFrom(other_scans).samples;
  const PoseMatrix of_exact = estimateFrom(scans, exact).samples;
  ASSERT_GT(of_exact.rows(), 0);

  const PreparedCloud target(scans.target);
  const auto drawsOf = [&](const Eigen::Matrix3Xd& source, const Options& options) {
    return estimatePosterior(source, target, Vector6d::Zero(), options).samples;
  };
  // Two threads meet an unprepared target.
  PoseMatrix draws;
  std::thread first([&] { draws = drawsOf(scans.source, calibratedOptions()); });
  EXPECT_EQ(drawsOf(other_scans.source, calibratedOptions()), of_other);
  first.join();
  EXPECT_EQ(draws, expected);
  target.prepare(Preset::Exact);
  const PreparedCloud copy = target;
  EXPECT_EQ(copy.points().data(), target.points().data());
  EXPECT_EQ(estimatePosterior(scans.source, copy, Vector6d::Zero(), exact).samples,
            of_exact);
}

TEST(Calibrated, ThePreparedSourceIsTheNextTarget)
{
  const Scans scans;
  const Eigen::Matrix3Xd next = surface(93, 1400);
  const Options options = calibratedOptions();
  const PreparedCloud source(scans.source);
  const auto drawsOf = [&](const PreparedCloud& from, const PreparedCloud& to) {
    return estimatePosterior(from, to, Vector6d::Zero(), options).samples;
  };
  EXPECT_EQ(drawsOf(source, scans.target), estimateFrom(scans).samples);
  EXPECT_EQ(drawsOf(next, source), drawsOf(next, scans.source));
}

TEST(Calibrated, FindsPoseNoiseAndSixObservedDirections)
{
  // With 1500 points one direction is weak in a fifth of the runs, by chance.
  Scans scans;
  scans.source = surface(91, 2000);
  const PosteriorEstimate estimate = estimateFrom(scans);
  const Summary& summary = estimate.summary;
  ASSERT_EQ(summary.status, Status::Ok) << summary.message;
  EXPECT_EQ(estimate.samples.rows(), 2000);
  EXPECT_LT(test::squaredErrorOf(summary, scans.truth), test::chi_square_9999);
  const DataReport& data = summary.data;
  ASSERT_TRUE(data.is_available);
  EXPECT_FALSE(data.flags.any());
  // The scale of 2000 residuals has an error of 3 %, the surface adds to it.
  EXPECT_NEAR(data.noise_scale, noise, 0.15 * noise);
  ASSERT_EQ(data.directions.size(), 6u);
  for (const DataDirection& direction : data.directions)
    EXPECT_EQ(direction.observability, Observability::Observed);
}

TEST(Calibrated, ThePriorIsAboutTheCentroidUnlessSet)
{
  Scans scans;
  scans.source.row(0).array() += 2.0; // so that the frames differ
  scans.target.row(0).array() += 2.0;
  Options options = calibratedOptions();
  const PosteriorEstimate centroid = estimateFrom(scans, options);
  options.prior.frame = PriorFrame::Origin;
  const PosteriorEstimate origin = estimateFrom(scans, options);
  options.prior.frame = PriorFrame::Automatic;
  const PosteriorEstimate automatic = estimateFrom(scans, options);
  EXPECT_EQ(automatic.samples, centroid.samples);
  EXPECT_NE(automatic.samples, origin.samples);
}

TEST(Calibrated, ATreeGivesItsPoints)
{
  Scans scans;
  scans.target = scans.target.cast<float>().cast<double>();
  const KdTree tree(scans.target.cast<float>());
  Options options = calibratedOptions();
  options.chains.num_draws = 200;
  const auto estimate =
      estimatePosterior(scans.source, tree, Vector6d::Zero(), options);
  EXPECT_EQ(estimate.samples, estimateFrom(scans, options).samples);
}

TEST(Calibrated, FarCoordinatesLoseNothing)
{
  // A target far out (UTM) with a guess that is as far out: the same posterior, moved.
  // Chains of rounded numbers part in time, so the means agree as those of other draws.
  Scans scans;
  const Summary here = estimateFrom(scans).summary;
  Vector6d offset = Vector6d::Zero();
  offset.head<3>() << 500000.0, 5400000.0, 300.0;
  scans.target.colwise() += offset.head<3>();
  const Summary there =
      estimatePosterior(scans.source, scans.target, offset, calibratedOptions())
          .summary;
  ASSERT_EQ(there.status, Status::Ok) << there.message;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto &a = here.coordinates[k], &b = there.coordinates[k];
    EXPECT_NEAR(b.mean - offset[static_cast<Eigen::Index>(k)],
                a.mean,
                5.0 * std::hypot(a.mcse, b.mcse))
        << k;
  }
  EXPECT_NEAR(there.data.noise_scale, here.data.noise_scale, 1e-3 * noise);
}

/** Random points of a floor of rooms, 5 x 5 m each, behind walls of 0.15 m, or of the
 * part of it that can be seen from within one room.
 * \param[in] num_rooms on each side */
Eigen::Matrix3Xd
rooms(Random& random, int num_rooms, bool is_seen_from_within, Eigen::Index num_points)
{
  constexpr double size = 5.0, height = 2.5, half_wall = 0.075, sigma = 0.01;
  const double extent = num_rooms * size;
  const int num_faces = is_seen_from_within ? 4 : 4 * (num_rooms + 1);
  const double area_of_floor = extent * extent, area_of_face = extent * height;
  Eigen::Matrix3Xd points(3, num_points);
  for (auto point : points.colwise()) {
    const double place =
        random.uniform() * (area_of_floor + num_faces * area_of_face) - area_of_floor;
    const double along = extent * random.uniform();
    if (place < 0.0) {
      point << extent * random.uniform(), along, 0.0;
    }
    else {
      const int face = static_cast<int>(place / area_of_face);
      // Alternately in front of a wall and behind it.
      const int wall = is_seen_from_within ? face / 2 : face / 4;
      const int side = is_seen_from_within ? 1 - 2 * wall : (face % 4 < 2 ? 1 : -1);
      point << wall * size + side * half_wall, along, height * random.uniform();
      if (face % 2 == 1)
        std::swap(point.x(), point.y());
    }
    for (double& coordinate : point)
      coordinate += sigma * random.normal();
  }
  return points;
}

TEST(Calibrated, AScanIsKnownInALargeMapAsInAMapOfItsRoom)
{
  // Points of the building are 0.16 m apart, as far as the faces of a wall.
  constexpr int num_rooms = 6;
  Random random(95, 0);
  const Eigen::Matrix3Xd scan = rooms(random, 1, true, 4000);
  const Eigen::Matrix3Xd building = rooms(random, num_rooms, false, 120000);
  const Eigen::Vector3d corner(10.0, 15.0, 0.0);
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < building.cols(); ++i) {
    const Eigen::Vector3d point = building.col(i) - corner;
    if (point.head<2>().minCoeff() > -0.5 && point.head<2>().maxCoeff() < 5.5)
      near.push_back(i);
  }
  Vector6d guess;
  guess << corner + Eigen::Vector3d(0.1, -0.05, 0.08), 0.01, -0.02, 0.03;
  Vector6d truth;
  truth << corner, 0.0, 0.0, 0.0;
  const auto summaryIn = [&](const Eigen::Matrix3Xd& map) {
    return estimatePosterior(scan, map, guess, calibratedOptions()).summary;
  };
  const Summary in_building = summaryIn(building);
  const Summary in_room = summaryIn(building(Eigen::all, near));
  ASSERT_EQ(in_building.status, Status::Ok) << in_building.message;
  EXPECT_LT(test::squaredErrorOf(in_building, truth), test::chi_square_9999);
  EXPECT_LT(test::squaredErrorOf(in_room, truth), test::chi_square_9999);
  const auto sizeOf = [](const Summary& summary) {
    return std::pow(summary.covariance(CovarianceConvention::R3xSO3).determinant(),
                    1.0 / 12.0);
  };
  // The points that are compared differ, and some 40 clusters of them tell J: five
  // standard errors of the root mean square of six deviations.
  EXPECT_NEAR(
      sizeOf(in_building) / sizeOf(in_room), 1.0, 5.0 / std::sqrt(2.0 * 40.0 * 6.0));
  // A tenth of the noise, which patches behind walls would not allow.
  EXPECT_LT(sizeOf(in_building), 0.001);
}

/** A table of 1 x 0.6 m with many small boxes, of which tops and sides are seen [m]. */
Eigen::Matrix3Xd
boxesOnATable(std::uint64_t seed, Eigen::Index num_points)
{
  constexpr int num_boxes = 30;
  constexpr double size = 0.01, height = 0.02;
  Random random(seed, 0);
  Eigen::Matrix3Xd points(3, num_points);
  for (auto point : points.colwise()) {
    const auto box = static_cast<double>(random.index(num_boxes));
    const Eigen::Vector2d corner(-0.45 + 0.032 * box, 0.2 * std::sin(2.0 * box));
    Eigen::Vector2d place;
    for (const Eigen::Index i : {1, 0})
      place[i] = random.uniform();
    const double part = random.uniform();
    point.z() = height;
    if (part < 0.7) {
      place = {place.x() - 0.5, 0.6 * place.y() - 0.3};
      point.z() = 0.0;
    }
    else {
      if (part > 0.85) { // A side.
        point.z() *= place.y();
        const std::size_t side = random.index(4);
        place[static_cast<Eigen::Index>(side / 2)] = static_cast<double>(side % 2);
      }
      place = corner + size * place;
    }
    point.head<2>() = place;
    for (const Eigen::Index i : {2, 1, 0})
      point[i] += 0.001 * random.normal();
  }
  return points;
}

TEST(Calibrated, ASparseSourceIsKnownOnADenseTarget)
{
  // The target's points, against patches as wide as several boxes, hide motions of
  // three of these five sources.
  int num_known = 0, num_of_source_alone = 0;
  for (const std::uint64_t seed : {101, 103, 105, 107, 109}) {
    const Summary summary = estimatePosterior(boxesOnATable(seed, 2000),
                                              boxesOnATable(seed + 1, 60000),
                                              {0.02, -0.01, 0.01, 0.01, 0.02, -0.02},
                                              calibratedOptions())
                                .summary;
    EXPECT_LT(test::squaredErrorOf(summary, Vector6d::Zero()), test::chi_square_9999);
    num_of_source_alone += std::isnan(summary.data.active_fraction_of_target);
    const auto& directions = summary.data.directions;
    num_known += std::all_of(
        directions.begin(), directions.end(), [](const DataDirection& direction) {
          return direction.observability == Observability::Observed;
        });
  }
  EXPECT_GE(num_known, 4);
  EXPECT_GE(num_of_source_alone, 3);
}

/** A cloud and three more pieces of surface beside it. */
Eigen::Matrix3Xd
fourTimesAsWide(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& way)
{
  const Eigen::Index num_points = points.cols();
  Eigen::Matrix3Xd wide(3, 4 * num_points);
  wide.leftCols(num_points) = points;
  const double steps[] = {3.0, -3.0, 6.0};
  for (int k = 0; k < 3; ++k)
    wide.middleCols((k + 1) * num_points, num_points) =
        surface(94 + static_cast<std::uint64_t>(k), num_points).colwise() +
        steps[k] * way;
  return wide;
}

TEST(Calibrated, PointsBesideTheSurfaceOfBothCloudsMakeItDoubtful)
{
  // Three quarters of what each cloud shows are where the other one saw nothing.
  Scans scans;
  scans.source = fourTimesAsWide(scans.source, Eigen::Vector3d::UnitX());
  scans.target = fourTimesAsWide(scans.target, Eigen::Vector3d::UnitY());
  const Summary summary = estimateFrom(scans).summary;
  EXPECT_EQ(summary.status, Status::Doubtful) << summary.message;
  EXPECT_TRUE(summary.data.flags.low_support);
  EXPECT_NE(summary.message.find("of the source points"), std::string::npos);
  EXPECT_TRUE(hasUsableMean(summary.status));
  // The points cover all of the surfaces alike.
  EXPECT_NEAR(summary.data.active_fraction, 0.25, 0.04);
}

TEST(Calibrated, ATargetThatIsPartOfTheSourceIsEnough)
{
  Scans scans;
  scans.source = fourTimesAsWide(scans.source, Eigen::Vector3d::UnitX());
  const Summary summary = estimateFrom(scans).summary;
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
  EXPECT_NEAR(summary.data.active_fraction, 0.25, 0.04);
  EXPECT_GT(summary.data.active_fraction_of_target, 0.9);
}

/** No draws, and a status with a word in its message. */
void
expectFailure(const PosteriorEstimate& estimate, Status status, const char* word)
{
  EXPECT_EQ(estimate.summary.status, status) << estimate.summary.message;
  EXPECT_NE(estimate.summary.message.find(word), std::string::npos)
      << estimate.summary.message;
  EXPECT_EQ(estimate.samples.rows(), 0);
  EXPECT_FALSE(estimate.summary.data.is_available);
}

TEST(Calibrated, CloudsThatCannotDoAndASearchInTheirPlaceAreAStatus)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect = [](Status status, const char* word, const auto& spoil) {
    Scans scans;
    spoil(scans);
    expectFailure(estimateFrom(scans), status, word);
  };
  expect(Status::InvalidInput, "source has 29", [](Scans& scans) {
    scans.source = surface(91, 29);
  });
  expect(Status::InvalidInput, "source has 0", [](Scans& s) { s.source.resize(3, 0); });
  expect(Status::InvalidInput, "non-finite", [&](Scans& s) { s.source(0, 0) = nan; });
  expect(Status::InvalidInput, "target has 20", [&](Scans& scans) {
    scans.target.row(1).tail(scans.target.cols() - 20).setConstant(nan);
  });
  expect(Status::TooFewCorrespondences, "surface", [](Scans& scans) {
    scans.target.colwise() = Eigen::Vector3d(0.1, 0.2, 0.3);
  });
  const Scans scans;
  expectFailure(estimatePosterior(scans.source,
                                  test::BruteForceSearch(scans.target),
                                  Vector6d::Zero(),
                                  calibratedOptions()),
                Status::InvalidOptions,
                "target's points");
}

TEST(Calibrated, CanBeCancelledBeforeTheEstimateAndWhileDrawing)
{
  const Scans scans;
  for (const int max_calls : {0, 10}) {
    int num_calls = 0;
    const auto estimate =
        estimatePosterior(scans.source,
                          scans.target,
                          Vector6d::Zero(),
                          calibratedOptions(),
                          [&](const Progress&) { return num_calls++ < max_calls; });
    EXPECT_EQ(estimate.summary.status, Status::Cancelled);
    EXPECT_LT(estimate.samples.rows(), 20);
  }
}

TEST(RandomChoice, IsWithoutRepetitionInRandomOrder)
{
  const auto choose = [](Eigen::Index size, std::uint64_t seed) {
    Random random(seed, 0);
    return randomChoice(1000, size, random);
  };
  const std::vector<Eigen::Index> chosen = choose(400, 1);
  ASSERT_EQ(chosen.size(), 400U);
  EXPECT_EQ(choose(400, 1), chosen);
  EXPECT_NE(choose(400, 2), chosen);
  // The mean of the first 100 has a standard deviation of 289 / 10.
  const double mean =
      std::accumulate(chosen.begin(), chosen.begin() + 100, 0.0) / 100.0;
  EXPECT_NEAR(mean, 499.5, 4.0 * 28.9);
  std::vector<Eigen::Index> sorted = choose(5000, 1);
  ASSERT_EQ(sorted.size(), 1000U);
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i)
    EXPECT_EQ(sorted[i], static_cast<Eigen::Index>(i));
}

} // namespace
} // namespace bayesian_icp
