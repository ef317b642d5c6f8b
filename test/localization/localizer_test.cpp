// What a node of ROS does with a map, priors and clouds, without ROS.
#include "io/errors.h"
#include "localization/localization_test_support.h"
#include "localization/parameters.h"
#include "support/test_support.h"

#include <bayesian_icp/measurement.h>

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>

using namespace bayesian_icp;
using namespace bayesian_icp::test;
using app::Localization;
using app::Localizer;
using app::LocalizerOptions;

namespace {

constexpr std::int64_t stamp_ns = 1700000000 * second;

class LocalizerTest : public ::testing::Test {
protected:
  /** A prior that is wrong by 2 cm and 0.02 rad and says so. */
  app::StatedPose
  somePrior() const
  {
    const Vector6d offset = Vector6d::Constant(0.02);
    return statedPose(matrixOf(offset) * trueTablePose(), 0.03, stamp_ns - second / 10);
  }

  void
  giveAll(Localizer& localizer) const
  {
    localizer.setMap(map_);
    localizer.addPrior(somePrior());
  }

  /** What a new localizer with a good map and a good prior says of \p cloud. */
  Localization
  localized(const pcl::PCLPointCloud2& cloud) const
  {
    Localizer localizer{LocalizerOptions()};
    giveAll(localizer);
    return localizer.localize(cloud, stamp_ns);
  }

  Localizer localizer_{LocalizerOptions()};

  const pcl::PCLPointCloud2::Ptr map_ = tableCloud("target", "map");
  const pcl::PCLPointCloud2::Ptr cloud_ = tableCloud("source", "base_link");
};

void
expectRefusal(const Localization& result, const std::string& words)
{
  EXPECT_EQ(result.level, Localization::Level::Error);
  EXPECT_NE(result.message.find(words), std::string::npos)
      << words << ": " << result.message;
  EXPECT_FALSE(result.posterior);
  EXPECT_FALSE(result.measurement);
  EXPECT_EQ(result.draws.rows(), 0);
}

void
expectSame(const Localization& a, const Localization& b)
{
  ASSERT_TRUE(a.posterior && b.posterior);
  EXPECT_EQ(a.message, b.message);
  EXPECT_EQ(a.posterior->mean, b.posterior->mean);
  EXPECT_EQ(a.draws, b.draws);
}

} // namespace

TEST_F(LocalizerTest, FindsThePose)
{
  const Localization result = localized(*cloud_);
  ASSERT_TRUE(result.posterior && result.measurement) << result.message;
  EXPECT_NE(result.level, Localization::Level::Error);
  EXPECT_EQ(result.draws.rows(), LocalizerOptions().settings.options.chains.num_draws);
  const Vector6d truth = poseOf(trueTablePose());
  for (const auto& estimate : {*result.posterior, *result.measurement}) {
    EXPECT_LT(squaredErrorOf(estimate, truth), chi_square_9999);
    EXPECT_LT((estimate.mean - truth).head<3>().norm(), 0.003);
  }
}

TEST_F(LocalizerTest, SamplesWhatTheClassSamplesWithThisPrior)
{
  const PriorOptions prior = app::priorFrom(somePrior()).options;
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  const auto toCloud = [](const pcl::PCLPointCloud2& blob) {
    const auto cloud = pcl::make_shared<Cloud>();
    pcl::fromPCLPointCloud2(blob, *cloud);
    return cloud;
  };
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double> icp;
  icp.setPrior(prior.mean, prior.variance);
  icp.setPriorFrame(PriorFrame::Origin);
  icp.setInputSource(toCloud(*cloud_));
  icp.setInputTarget(toCloud(*map_));
  Cloud moved;
  icp.align(moved, matrixOf(prior.mean));
  const Localization result = localized(*cloud_);
  ASSERT_TRUE(result.posterior);
  EXPECT_EQ(result.posterior->mean, icp.getMean());
  EXPECT_EQ(result.draws, icp.getSamples());
}

TEST_F(LocalizerTest, GivesTheSameForTheSameAndSurvivesRefusals)
{
  giveAll(localizer_);
  const Localization first = localizer_.localize(*cloud_, stamp_ns);
  pcl::PCLPointCloud2 elsewhere = *cloud_;
  elsewhere.header.frame_id = "laser";
  expectRefusal(localizer_.localize(elsewhere, stamp_ns), "'laser'");
  expectSame(first, localizer_.localize(*cloud_, stamp_ns));
}

TEST_F(LocalizerTest, RefusesUntilMapAndPriorHaveCome)
{
  expectRefusal(localizer_.localize(*cloud_, stamp_ns), "no map has arrived");
  localizer_.setMap(map_);
  expectRefusal(localizer_.localize(*cloud_, stamp_ns), "no prior has arrived");
  localizer_.addPrior(somePrior());
  EXPECT_TRUE(localizer_.localize(*cloud_, stamp_ns).posterior);
}

TEST_F(LocalizerTest, RefusesFramesThatAreNotItsOwn)
{
  const auto odometry_map = tableCloud("target", "odom");
  localizer_.setMap(odometry_map);
  expectRefusal(localizer_.localize(*cloud_, stamp_ns),
                "the map's frame_id is 'odom', but must be 'map'");
  // It stays refused, as long as there is no other.
  expectRefusal(localizer_.localize(*cloud_, stamp_ns), "'odom'");
  localizer_.setMap(map_);
  app::StatedPose prior = somePrior();
  prior.frame = "odom";
  localizer_.addPrior(prior);
  expectRefusal(localizer_.localize(*cloud_, stamp_ns),
                "the prior's frame_id is 'odom', but must be 'map'");
  prior.frame = "/map"; // as ROS 1 had it
  localizer_.addPrior(prior);
  EXPECT_TRUE(localizer_.localize(*cloud_, stamp_ns).posterior);
}

TEST_F(LocalizerTest, TakesThePriorThatIsNearestInTime)
{
  localizer_.setMap(map_);
  app::StatedPose far_away = somePrior();
  far_away.position[0] += 100.0;
  for (const std::int64_t distance : {-second / 2, second / 2}) {
    far_away.stamp_ns = stamp_ns + distance;
    localizer_.addPrior(far_away);
    localizer_.addPrior(somePrior());
  }
  for (const std::int64_t stamp : {stamp_ns + second / 5, somePrior().stamp_ns - 100}) {
    far_away.stamp_ns = stamp;
    localizer_.addPrior(far_away);
  }
  expectSame(localizer_.localize(*cloud_, stamp_ns), localized(*cloud_));
}

TEST_F(LocalizerTest, RefusesPriorsOfOtherTimes)
{
  giveAll(localizer_);
  expectRefusal(localizer_.localize(*cloud_, stamp_ns + 2 * second),
                "the nearest is 2.1 s older than the cloud, but max_prior_age is 1 s");
  expectRefusal(localizer_.localize(*cloud_, stamp_ns - 2 * second), "1.9 s newer");
  LocalizerOptions patient;
  patient.max_prior_age = std::numeric_limits<double>::infinity();
  Localizer other(patient);
  giveAll(other);
  EXPECT_TRUE(other.localize(*cloud_, stamp_ns + 1000 * second).posterior);
}

TEST_F(LocalizerTest, RefusesCloudsThatAreNoClouds)
{
  const auto expect = [this](const std::string& words, const auto& spoil) {
    pcl::PCLPointCloud2 bad = *cloud_;
    spoil(bad);
    expectRefusal(localized(bad), words);
  };
  expect("the cloud has no points", [](auto& bad) {
    bad.width = bad.height = 0;
    bad.data.clear();
  });
  expect("bytes of data", [](auto& bad) { bad.data.pop_back(); });
  expect("bytes of data", [](auto& bad) { // whose product is 0 modulo 2^64
    bad.width = bad.height = 1U << 30U;
    bad.point_step = 16;
    bad.data.clear();
  });
  expect("points of 0 bytes", [](auto& bad) {
    bad.point_step = 0;
    bad.data.clear();
  });
  expect("no floating-point fields x, y and z",
         [](auto& bad) { bad.fields[2].name = "intensity"; });
  expect("is_bigendian", [](auto& bad) { bad.is_bigendian = 1; });
  expect("the cloud has no finite points", [](auto& bad) { // but NaN
    std::memset(bad.data.data(), 0xff, bad.data.size());
  });
  expect("points", [](auto& bad) {
    bad.width = 5;
    bad.data.resize(5 * bad.point_step);
  });
}

TEST_F(LocalizerTest, SkipsPointsThatAreNotFinite)
{
  pcl::PCLPointCloud2 with_nan = *cloud_;
  std::vector<std::uint8_t> nothing(100 * with_nan.point_step, 0xff);
  with_nan.data.insert(with_nan.data.begin() + 1000 * with_nan.point_step,
                       nothing.begin(),
                       nothing.end());
  with_nan.width += 100;
  expectSame(localized(with_nan), localized(*cloud_));
}

TEST_F(LocalizerTest, SaysWhyThereIsNoPosterior)
{
  localizer_.setMap(map_);
  app::StatedPose far_away = somePrior();
  far_away.position[0] += 1000.0;
  localizer_.addPrior(far_away);
  const Localization result = localizer_.localize(*cloud_, stamp_ns);
  EXPECT_EQ(result.level, Localization::Level::Error);
  EXPECT_FALSE(result.posterior) << result.message;
  EXPECT_FALSE(result.message.empty());
}

TEST_F(LocalizerTest, WidensTheMeasurementOfWhatIsDoubtful)
{
  // Three of four points of each cloud are of something that the other one lacks.
  const auto withMore = [](const pcl::PCLPointCloud2& message,
                           const std::array<float, 3>& heights) {
    pcl::PointCloud<pcl::PointXYZ> cloud;
    pcl::fromPCLPointCloud2(message, cloud);
    const std::size_t num_points = cloud.size();
    for (const float height : heights)
      for (std::size_t i = 0; i < num_points; ++i)
        cloud.push_back({cloud[i].x, cloud[i].y, cloud[i].z + height});
    const auto more = pcl::make_shared<pcl::PCLPointCloud2>();
    pcl::toPCLPointCloud2(cloud, *more);
    more->header = message.header;
    return more;
  };
  localizer_.setMap(withMore(*map_, {0.25F, 0.75F, 1.3F}));
  localizer_.addPrior(somePrior());
  const Localization result =
      localizer_.localize(*withMore(*cloud_, {0.5F, 1.0F, 1.5F}), stamp_ns);
  ASSERT_TRUE(result.posterior && result.measurement) << result.message;
  ASSERT_EQ(result.level, Localization::Level::Warning) << result.message;
  const PriorOptions prior = app::priorFrom(somePrior()).options;
  const PoseMeasurement stated =
      withoutPrior(*result.posterior, Prior(prior.mean, prior.variance));
  const auto convention = CovarianceConvention::R3xSO3;
  EXPECT_TRUE(result.measurement->covariance(convention)
                  .isApprox(9.0 * stated.estimate.covariance(convention), 1e-12));
}

TEST_F(LocalizerTest, AddsTheFloorToAPriorThatKnowsSomeMotionsExactly)
{
  app::StatedPose planar = somePrior();
  for (const int k : {2, 3, 4}) {
    planar.covariance.row(k).setZero();
    planar.covariance.col(k).setZero();
  }
  LocalizerOptions options;
  for (const double floor : {0.0, 0.03}) {
    options.prior_floor = {floor, floor};
    Localizer localizer(options);
    localizer.setMap(map_);
    localizer.addPrior(planar);
    const Localization result = localizer.localize(*cloud_, stamp_ns);
    EXPECT_EQ(result.posterior.has_value(), floor > 0.0) << result.message;
  }
}

TEST_F(LocalizerTest, HasNoMeasurementThatConflictsWithThePrior)
{
  localizer_.setMap(map_);
  const Vector6d offset = Vector6d::Constant(0.02);
  localizer_.addPrior(statedPose(matrixOf(offset) * trueTablePose(), 0.002, stamp_ns));
  const Localization result = localizer_.localize(*cloud_, stamp_ns);
  EXPECT_EQ(result.level, Localization::Level::Warning) << result.message;
  EXPECT_TRUE(result.posterior);
  EXPECT_FALSE(result.measurement);
}

TEST(Localization, HasNoMeasurementThatMayBeInAnotherBasin)
{
  Summary summary;
  summary.status = Status::Doubtful;
  summary.mean.setZero();
  summary.covariances.fill(1e-4 * Matrix6d::Identity());
  PriorOptions prior;
  prior.mean.setZero();
  const auto hasMeasurement = [&] {
    Localization result;
    app::addEstimate(summary, PoseMatrix(), prior, result);
    EXPECT_EQ(result.level, Localization::Level::Warning);
    EXPECT_TRUE(result.posterior);
    return result.measurement.has_value();
  };
  DataFlags& flags = summary.data.flags;
  flags.misfit = true;
  EXPECT_TRUE(hasMeasurement());
  flags.low_support = true;
  EXPECT_FALSE(hasMeasurement());
  flags.misfit = false;
  EXPECT_TRUE(hasMeasurement());
  flags.wrong_basin = true;
  EXPECT_FALSE(hasMeasurement());
}

TEST_F(LocalizerTest, CanBeCancelled)
{
  giveAll(localizer_);
  const Localization result =
      localizer_.localize(*cloud_, stamp_ns, [](const Progress&) { return false; });
  EXPECT_EQ(result.level, Localization::Level::Error);
  EXPECT_FALSE(result.posterior);
}

TEST_F(LocalizerTest, FillsMessages)
{
  const Localization result = localized(*cloud_);
  ASSERT_TRUE(result.posterior);
  const Header header{{1700000000, 5}, "map"};
  PoseWithCovarianceStamped pose;
  app::fillStampedPose(header, *result.posterior, pose);
  EXPECT_EQ(pose.header.frame_id, "map");
  EXPECT_EQ(pose.header.stamp.nanosec, 5U);
  const app::StatedPose stated = app::statedPoseOf(pose);
  EXPECT_LT((stated.position - result.posterior->mean.head<3>()).norm(), 1e-15);
  EXPECT_EQ(stated.covariance,
            result.posterior->covariance(CovarianceConvention::R3xSO3));

  PoseArray draws;
  app::fillPoseArray(header, result.draws, draws);
  ASSERT_EQ(draws.poses.size(), static_cast<std::size_t>(result.draws.rows()));
  EXPECT_EQ(draws.poses[7].position.y, result.draws(7, 1));

  DiagnosticArray diagnostics;
  app::fillDiagnostics(header, "localizer", result, diagnostics);
  ASSERT_EQ(diagnostics.status.size(), 1U);
  EXPECT_EQ(diagnostics.status[0].level, static_cast<int>(result.level));
  EXPECT_EQ(diagnostics.status[0].message, result.message);
  EXPECT_EQ(diagnostics.status[0].values.size(), result.values.size());
}

TEST(LocalizerParameters, AreOptionsOfThePrograms)
{
  const LocalizerOptions options = app::readParameters({{"preset", "exact"},
                                                        {"sigma", "0.01"},
                                                        {"seed", "7"},
                                                        {"threads", "1"},
                                                        {"one_to_one", "true"},
                                                        {"reciprocal", "false"},
                                                        {"map_frame", "world"},
                                                        {"max_prior_age_s", "inf"},
                                                        {"prior_floor_rad", "0.5"}});
  EXPECT_EQ(options.settings.options.preset, Preset::Exact);
  EXPECT_EQ(options.settings.options.exact.scale.measurement_sigma, 0.01);
  EXPECT_EQ(options.settings.options.chains.seed, 7U);
  EXPECT_EQ(options.settings.options.chains.num_threads, 1);
  EXPECT_TRUE(options.settings.is_one_to_one);
  EXPECT_FALSE(options.settings.is_reciprocal);
  EXPECT_EQ(options.map_frame, "world");
  EXPECT_EQ(options.cloud_frame, "base_link");
  EXPECT_EQ(options.max_prior_age, std::numeric_limits<double>::infinity());
  EXPECT_EQ(options.prior_floor.rotation, 0.5);
}

TEST(LocalizerParameters, ThatAreWrongAreRefusedByName)
{
  const auto expectRefusal =
      [](const std::string& name, const std::string& text, const std::string& words) {
        try {
          app::readParameters({{name, text}});
          ADD_FAILURE() << name << " was taken";
        }
        catch (const io::UsageError& error) {
          EXPECT_NE(std::string(error.what()).find(words), std::string::npos)
              << error.what();
        }
      };
  expectRefusal("sead", "1", "no parameter 'sead'");
  expectRefusal("prior_variance", "1", "no parameter 'prior_variance'");
  expectRefusal("max-distance", "1", "no parameter 'max-distance'");
  expectRefusal("seed", "-1", "seed");
  expectRefusal("preset", "best", "best");
  expectRefusal("sigma", "1", "sigma"); // not one of preset calibrated
  // What applies to ICP only, which does not run.
  expectRefusal("iterations", "9", "no parameter 'iterations'");
  expectRefusal("max_distance", "1", "max-distance has no effect");
  expectRefusal("one_to_one", "true", "one-to-one has no effect");
  expectRefusal("reciprocal", "true", "reciprocal has no effect");
  expectRefusal("reciprocal", "1", "true or false");
  expectRefusal("max_prior_age_s", "-1", "max_prior_age");
  expectRefusal("map_frame", "", "map_frame");
  expectRefusal("prior_floor_m", "-1", "floor");
}
