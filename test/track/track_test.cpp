// What a track does with good and bad steps, and its lines and files.
#include "graph/trajectory_files.h"
#include "support/test_support.h"
#include "track/registration.h"
#include "track/track.h"
#include "track/track_line.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/pipeline.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <stdexcept>

using namespace bayesian_icp;
using namespace bayesian_icp::test;
using app::StepKind;
using app::Track;
using app::TrackRequest;
using app::TrackStep;

namespace {

TrackRequest
requestOf(int num_scans)
{
  TrackRequest request;
  for (int k = 0; k < num_scans; ++k) {
    request.scans.push_back("scan_" + std::to_string(k) + ".pcd");
    request.times.push_back(100'000'000 * k);
  }
  return request;
}

app::MotionModel
uncertainModel()
{
  app::MotionModel model;
  model.velocity_covariance = 10.0 * Matrix6d::Identity();
  return model;
}

/** The next step: 0.1 m ahead of the scan before, turned a little, to 1 mm and 1 mrad.
 */
TrackStep
nextStep(const Track& track, StepKind kind)
{
  TrackStep step;
  step.scan = track.size();
  step.kind = kind;
  step.status = "ok";
  step.message = "a \"message\"";
  step.is_velocity_doubted = kind == StepKind::Widened;
  step.edge.target = track.target();
  step.edge.pose = track.prediction(false);
  if (kind == StepKind::Registered || kind == StepKind::Widened) {
    const double ahead = step.scan - step.edge.target;
    step.edge.pose.mean << 0.1 * ahead, 0.0, 0.01, 0.0, 0.001, 0.002 * ahead;
    step.edge.pose.covariance = 1e-6 * Matrix6d::Identity();
    step.edge.num_unmeasured = step.scan % 2;
    step.more_edges.assign(step.scan % 2, step.edge);
  }
  return step;
}

void
take(const std::vector<StepKind>& kinds, Track& track)
{
  for (const StepKind kind : kinds)
    track.take(nextStep(track, kind));
}

constexpr auto registered = StepKind::Registered;
constexpr auto predicted = StepKind::Predicted;

} // namespace

TEST(Track, RegistersEachScanToTheOneBefore)
{
  Track track(uncertainModel(), requestOf(4).times, 1);
  EXPECT_EQ(track.target(), 0);
  take({registered, StepKind::Widened, registered}, track);
  EXPECT_EQ(track.target(), 3);
  ASSERT_EQ(track.targetScans().size(), 1u);
  EXPECT_EQ(track.targetScans()[0].first, 3);
  EXPECT_TRUE(track.targetCovariance(Eigen::Matrix4d::Identity()).isZero());
  EXPECT_NEAR(track.poses()[3].mean[0], 0.3, 0.01);
}

TEST(Track, KeepsTheTargetWhereAScanCannotBeRegistered)
{
  Track track(uncertainModel(), requestOf(5).times, 1);
  take({registered, predicted, predicted}, track);
  EXPECT_EQ(track.target(), 1);
  EXPECT_EQ(track.numFailures(), 2);
  const double sd = std::sqrt(track.poses()[3].covariance(0, 0));
  take({registered}, track);
  EXPECT_EQ(track.target(), 4);
  EXPECT_EQ(track.numFailures(), 0);
  EXPECT_GT(sd, 10.0 * std::sqrt(track.poses()[4].covariance(0, 0)));
}

TEST(Track, BeginsAnewWithTheScanOfASplit)
{
  Track track(uncertainModel(), requestOf(5).times, 1);
  take({registered, predicted, predicted, StepKind::Split}, track);
  EXPECT_EQ(track.target(), 4);
  EXPECT_EQ(track.numFailures(), 0);
  EXPECT_TRUE(track.targetScans()[0].second.isIdentity(1e-12));
}

TEST(Track, MakesAMapOfTheLastScans)
{
  Track track(uncertainModel(), requestOf(9).times, 3);
  take({registered, registered}, track);
  EXPECT_EQ(track.target(), 0);
  take({registered}, track);
  EXPECT_EQ(track.target(), 3);
  ASSERT_EQ(track.targetScans().size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const auto& [scan, T_target_scan] = track.targetScans()[std::size_t(k)];
    EXPECT_EQ(scan, k + 1);
    EXPECT_NEAR(T_target_scan(0, 3), 0.1 * (scan - 3), 0.01);
  }
  // Two of the three scans are out of place by their own errors and the target's: twice
  // 1 mm^2 along x, and more across, where rotations of the scan ahead count.
  const Matrix6d covariance = track.targetCovariance(Eigen::Matrix4d::Identity());
  EXPECT_NEAR(covariance(0, 0), 2.0 / 3.0 * 2e-6, 1e-8);
  EXPECT_GT(covariance(1, 1), covariance(0, 0));
  // A scan 0.1 or 0.2 m behind that is turned to the left moves the map's origin left.
  EXPECT_NEAR(covariance(1, 5), (0.1 + 0.2) / 3.0 * 1e-6, 1e-8);
  // A map that is out of place by exp(xi) moves a scan by T^-1 exp(xi) T.
  const Eigen::Matrix4d T = matrixOf({3.0, -2.0, 1.0, 0.3, -0.2, 0.7});
  constexpr double step = 1e-5;
  Matrix6d moved;
  for (int k = 0; k < 6; ++k) {
    const Vector6d xi = step * Vector6d::Unit(k);
    moved.col(k) =
        (logSE3(T.inverse() * expSE3(xi) * T) - logSE3(T.inverse() * expSE3(-xi) * T)) /
        (2.0 * step);
  }
  EXPECT_TRUE(
      track.targetCovariance(T).isApprox(moved * covariance * moved.transpose(), 1e-7));
}

TEST(Track, GoesOnFromItsLinesAsIfItHadNotStopped)
{
  const TrackRequest request = requestOf(8);
  Track track(uncertainModel(), request.times, 2),
      again(uncertainModel(), request.times, 2);
  for (const StepKind kind : {registered,
                              StepKind::Widened,
                              predicted,
                              predicted,
                              StepKind::Split,
                              registered,
                              registered}) {
    track.take(nextStep(track, kind));
    again.take(readTrackLine(trackLine(request, track), request, again.size()));
  }
  EXPECT_EQ(track.target(), again.target());
  EXPECT_GT(track.numUnmeasured(), 0u);
  EXPECT_EQ(track.numUnmeasured(), again.numUnmeasured());
  for (int k = 0; k < track.size(); ++k) {
    EXPECT_EQ(track.poses()[std::size_t(k)].mean, again.poses()[std::size_t(k)].mean);
    EXPECT_EQ(track.poses()[std::size_t(k)].covariance,
              again.poses()[std::size_t(k)].covariance);
  }
  EXPECT_EQ(app::g2oText(track.poses(), track.edges()),
            app::g2oText(again.poses(), again.edges()));
  EXPECT_EQ(app::tumCovarianceText(track.times(), track.poses()),
            app::tumCovarianceText(again.times(), again.poses()));
}

TEST(Track, TellsHowFarARegistrationIsFromThePrediction)
{
  Track track(uncertainModel(), requestOf(3).times, 1);
  TrackStep step = nextStep(track, registered);
  const app::GaussianPose expected = track.prediction(false);
  const double variance = expected.covariance(0, 0) + step.edge.pose.covariance(0, 0);
  step.edge.pose.mean = expected.mean;
  step.edge.pose.mean[0] += 2.0 * std::sqrt(variance);
  track.take(step);
  EXPECT_NEAR(track.innovations().back(), 4.0, 1e-3);
  take({predicted}, track);
  EXPECT_TRUE(std::isnan(track.innovations().back()));
}

TEST(Registered, TriplesTheDeviationsOfWhatIsDoubtful)
{
  // Both clouds have the same surface, and balls that the other one does not have.
  const auto withBalls = [](std::uint64_t seed) {
    constexpr int num_points = 3000, num_balls = 10;
    Random random(seed, 1);
    Eigen::Matrix3Xd balls(3, 3 * num_points);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < balls.cols(); ++i) {
      if (i % (balls.cols() / num_balls) == 0)
        centre << random.uniform() - 0.5, random.uniform() - 0.5,
            random.uniform() + 0.3;
      balls.col(i) = centre + 0.1 * random.normal6().head<3>().normalized();
    }
    Eigen::Matrix3Xd points(3, num_points + balls.cols());
    points << wavySurface(seed, num_points, 0.05), balls;
    return points;
  };
  const PreparedCloud source(withBalls(1)), target(withBalls(2));
  Options options;
  options.prior.frame = PriorFrame::Origin;
  options.prior.mean.setZero();
  const app::Registration result = app::registered(source, target, options, nullptr);
  ASSERT_EQ(result.quality, app::Quality::Doubtful) << result.message;
  const Summary summary =
      estimatePosterior(source, target, options.prior.mean, options).summary;
  const PoseMeasurement of_clouds = withoutPrior(
      PoseEstimate(summary), Prior(options.prior.mean, options.prior.variance));
  EXPECT_TRUE(result.edge.pose.covariance.isApprox(
      9.0 * of_clouds.estimate.covariance(CovarianceConvention::RightSE3), 1e-12));
}

TEST(Track, RefusesLinesOfAnotherOne)
{
  const TrackRequest request = requestOf(3);
  Track track(uncertainModel(), request.times, 1);
  take({registered}, track);
  const std::string line = trackLine(request, track);
  EXPECT_NO_THROW(readTrackLine(line, request, 1));
  EXPECT_THROW(readTrackLine(line, request, 2), std::runtime_error);
  TrackRequest other = request;
  other.acceleration = 1.0;
  EXPECT_THROW(readTrackLine(line, other, 1), std::runtime_error);
  other = request;
  other.angular_acceleration = 1.0;
  EXPECT_THROW(readTrackLine(line, other, 1), std::runtime_error);
  other = request;
  other.times[1] = 150'000'000;
  EXPECT_THROW(readTrackLine(line, other, 1), std::runtime_error);
  EXPECT_THROW(readTrackLine("{}", request, 1), std::exception);
}
