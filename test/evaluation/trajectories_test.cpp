// Errors of trajectories, and trajectories of edges whose errors are drawn from their
// covariances.
#include "evaluation/evaluate_tool.h"
#include "evaluation/paper_pairs.h"
#include "trajectories/drives.h"
#include "trajectories/trajectory_run.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>
#include <fstream>
#include <string>
#include <tuple>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;
using app::GaussianPose;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** Along the x axis, one scan per metre. */
std::vector<Isometry3d>
straightLine(int num_scans)
{
  std::vector<Isometry3d> poses;
  for (int k = 0; k < num_scans; ++k)
    poses.emplace_back(Eigen::Translation3d(k, 0.0, 0.0));
  return poses;
}

GaussianPose
known(const Isometry3d& pose, const Matrix6d& covariance = Matrix6d::Identity())
{
  return {poseOf(pose.matrix()), covariance};
}

/** 1 m apart on a bent way, with edges to up to three scans before, of two methods:
 * `calibrated` states the covariances of its errors, which are small across the motion
 * and large along it every other time; `gicp` makes the same errors and calls all ten
 * times smaller; `closed-form` has no edge. */
RegisteredRecording
drawnRecording(const std::string& name, std::uint64_t seed)
{
  RegisteredRecording registered;
  registered.recording.name = name;
  registered.recording.quality = "exact";
  registered.seed = seed;
  Vector6d step;
  step << 1.0, 0.0, 0.05, 0.0, 0.02, 0.1;
  Isometry3d pose = Isometry3d::Identity();
  for (int k = 0; k < 20; ++k, pose = pose * Isometry3d(expSE3(step)))
    registered.recording.poses.push_back(pose);
  Random random(seed, 7);
  Matrix6d common;
  for (int k = 0; k < 6; ++k)
    common.col(k) = random.normal6();
  std::vector<Vector6d> noises;
  for (std::size_t k = 0; k < registered.recording.poses.size(); ++k)
    noises.push_back(random.normal6());
  for (const auto& [target, source] : pairsOf(registered.recording, 3, 0.5)) {
    Vector6d deviations;
    deviations << (source % 2 == 0 ? 0.5 : 0.01), 0.01, 0.01, Vector3d::Constant(0.002);
    const app::SharedNoise shared;
    const Eigen::Matrix4d T =
        registered.recording.relativePose(std::size_t(target), std::size_t(source))
            .matrix();
    const Vector6d error = deviations.cwiseProduct(
        std::sqrt(shared.scan) * (noises[std::size_t(source)] -
                                  app::noiseToSource(T) * noises[std::size_t(target)]) +
        std::sqrt(shared.common) * common * app::directionOf(T) +
        std::sqrt(shared.own()) * random.normal6());
    EdgeRun run;
    run.mean = poseOf(T * expSE3(-error));
    for (const std::string& method : edge_methods) {
      run.name = {name, seed, target, source, method, ""};
      run.complaint = method == "closed-form" ? "none" : "";
      const double scale = method == "gicp" ? 0.1 : 1.0;
      run.covariance = (scale * deviations).cwiseAbs2().asDiagonal();
      registered.edges.push_back(run);
    }
  }
  return registered;
}

class TrajectoriesCommand : public EvaluateTool {
protected:
  CommandResult
  run(const std::string& arguments) const
  {
    return EvaluateTool::run("trajectories " + arguments);
  }
};

} // namespace

TEST(Trajectories, ACameraAlongABareWallIsRightAboutTheMotionsThatItSees)
{
  // Most of what the camera sees is a wall and the floor. Two views of them overlap
  // most where the camera has not moved, which must not count as evidence. Scans that
  // are ten apart have half of their points in common, and fits slide along the wall,
  // by up to a metre. A free direction that turns on its way is wrong there.
  constexpr int num_runs = 4;
  // Of scans 20 and 30, which have the fewest, one run may find two modes.
  for (const auto& [target, source, least_used] : {std::tuple(21, 24, num_runs),
                                                   std::tuple(20, 30, num_runs - 1),
                                                   std::tuple(15, 25, num_runs),
                                                   std::tuple(65, 75, num_runs)}) {
    double sum = 0.0;
    int num_used = 0;
    for (std::uint64_t seed = 1; seed <= num_runs; ++seed) {
      const Recording drive = makeDrive("room_camera", seed, 100);
      const EdgeName name{drive.name, seed, target, source, "calibrated", ""};
      const EdgeRun run = registeredEdge(name,
                                         drive.read(std::size_t(source)),
                                         drive.read(std::size_t(target)),
                                         guessOf(drive, seed, target, source));
      if (run.complaint.find("several_modes") != std::string::npos)
        continue;
      ASSERT_EQ(run.complaint, "") << seed;
      const app::GraphEdge edge = graphEdgeOf(run);
      const Vector6d error =
          logSE3(Isometry3d(edge.T_target_source).inverse().matrix() *
                 drive.relativePose(std::size_t(target), std::size_t(source)).matrix());
      sum += error.dot(edge.covariance.ldlt().solve(error));
      ++num_used;
    }
    EXPECT_GE(num_used, least_used) << target << ' ' << source;
    EXPECT_LT(sum, quantile(boost::math::chi_squared(6 * num_used), 0.999))
        << target << ' ' << source;
  }
}

TEST(Trajectories, AlignedErrorIsThatOfTheShape)
{
  const std::vector<Isometry3d> truth = straightLine(40);
  Isometry3d elsewhere(Eigen::AngleAxisd(0.3, Vector3d(1.0, 2.0, 3.0).normalized()));
  elsewhere.translation() = Vector3d(4.0, 5.0, 6.0);
  std::vector<Isometry3d> world;
  std::vector<GaussianPose> same, zigzag;
  for (int k = 0; k < 40; ++k) {
    const Isometry3d& pose = truth[std::size_t(k)];
    world.push_back(elsewhere * pose);
    same.push_back(known(pose));
    Isometry3d moved = pose;
    // Two up, two down, so that the first one is no exception; a line fits best.
    moved.translation().z() += (k / 2) % 2 == 0 ? 0.1 : -0.1;
    zigzag.push_back(known(moved));
  }
  EXPECT_NEAR(scoreOf(same, world).ate, 0.0, 1e-12);
  EXPECT_NEAR(scoreOf(same, world).rpe_translation, 0.0, 1e-12);
  // The best line turns by less than 0.1 m over 39 m: of second order.
  EXPECT_NEAR(scoreOf(zigzag, truth).ate, 0.1, 0.001);
}

TEST(Trajectories, RelativeErrorsAreThoseOfTheSteps)
{
  const std::vector<Isometry3d> truth = straightLine(11);
  std::vector<GaussianPose> longer;
  for (int k = 0; k < 11; ++k) {
    Isometry3d pose(Eigen::AngleAxisd(0.02 * k, Vector3d::UnitX()));
    pose.translation().x() = 1.05 * k;
    longer.push_back(known(pose));
  }
  const TrajectoryScore score = scoreOf(longer, truth);
  EXPECT_NEAR(score.rpe_translation, 0.05, 1e-12);
  EXPECT_NEAR(score.rpe_rotation, 0.02, 1e-9);
  EXPECT_NEAR(score.drift_translation, 0.5, 1e-12);
  EXPECT_NEAR(score.drift_rotation, 0.2, 1e-9);
  // 0.05 m at each step about the middle: the mean square of -5 ... 5 is 10.
  EXPECT_NEAR(score.ate, 0.05 * std::sqrt(10.0), 1e-9);
}

TEST(Trajectories, ErrorsAreComparedWithTheirCovariances)
{
  const std::vector<Isometry3d> truth = straightLine(3);
  Vector6d variances;
  variances << 0.04, 1.0, 1.0, 1.0, 1.0, 0.25;
  const Matrix6d covariance = variances.asDiagonal();
  Isometry3d last = truth[2];
  last.translation().x() += 0.4; // two deviations
  const TrajectoryScore score = scoreOf(
      {known(truth[0]), known(truth[1], covariance), known(last, covariance)}, truth);
  EXPECT_NEAR(score.nees_per_degree_of_last, 4.0 / 6.0, 1e-9);
  EXPECT_NEAR(score.nees_per_degree, 2.0 / 6.0, 1e-9);
  // With a reference that is as inaccurate as the estimate.
  EXPECT_NEAR(
      scoreOf({known(truth[0]), known(truth[1], covariance), known(last, covariance)},
              truth,
              {0.2, 0.0})
          .nees_per_degree_of_last,
      2.0 / 6.0,
      1e-9);
}

TEST(Trajectories, EachScanIsRegisteredToThoseBeforeAndToItsPlaceOfLongAgo)
{
  Recording recording;
  recording.poses = straightLine(14);
  recording.poses.emplace_back(Eigen::Translation3d(2.0, 0.4, 0.0));
  recording.poses.emplace_back(Eigen::Translation3d(1.0, 0.4, 0.0));
  const auto pairs = pairsOf(recording, 2, 0.5);
  ASSERT_EQ(pairs.size(), 1u + 2u * 14u + 1u);
  EXPECT_EQ(pairs[0], std::make_pair(0, 1));
  EXPECT_EQ(pairs[1], std::make_pair(1, 2));
  EXPECT_EQ(pairs[2], std::make_pair(0, 2));
  EXPECT_EQ(pairs.back(), std::make_pair(1, 15));
}

TEST(Trajectories, RightCovariancesMakeTheBestTrajectoriesAndSayHowGoodTheyAre)
{
  constexpr int num_recordings = 40;
  std::vector<RegisteredRecording> recordings;
  for (int k = 0; k < num_recordings; ++k)
    recordings.push_back(drawnRecording(k % 2 == 0 ? "a" : "b", std::uint64_t(k)));
  double nees_of_last = 0.0, cycles = 0.0;
  int num_better = 0;
  const std::vector<TrajectoryRun> runs = trajectoriesOf(recordings);
  ASSERT_EQ(runs.size(), 7u * num_recordings);
  for (std::size_t k = 0; k < runs.size(); k += 7) {
    const TrajectoryRun &right = runs[k], &constant = runs[k + 1], &bold = runs[k + 5];
    EXPECT_EQ(right.covariances, "calibrated");
    EXPECT_EQ(constant.covariances, "constant");
    EXPECT_EQ(bold.means + bold.covariances, "gicpgicp");
    nees_of_last += right.score.nees_per_degree_of_last / num_recordings;
    cycles += right.cycle_nees_per_degree / num_recordings;
    num_better += right.score.ate < constant.score.ate ? 1 : 0;
    EXPECT_GT(bold.score.nees_per_degree, 5.0 * right.score.nees_per_degree);
    EXPECT_EQ(right.num_edges, 54);
    EXPECT_EQ(runs[k + 3].num_edges, 0) << "none has a covariance";
  }
  // Chi-square with 6 degrees in each recording, so a deviation of sqrt(2 / 6 / 40).
  EXPECT_NEAR(nees_of_last, 1.0, 3.0 * std::sqrt(2.0 / 6.0 / num_recordings));
  // 53 cycles of six degrees, which share edges: no more certain than 19 of them.
  EXPECT_NEAR(cycles, 1.0, 3.0 * std::sqrt(2.0 / 6.0 / 19.0 / num_recordings));
  // A coin would have 20 +- 3.2.
  EXPECT_GE(num_better, 30);
}

TEST(Trajectories, OfARecordingAloneHaveNoConstantCovariance)
{
  RegisteredRecording alone = drawnRecording("a", 1);
  std::vector<TrajectoryRun> runs = trajectoriesOf({alone});
  ASSERT_EQ(runs.size(), 5u);
  for (const TrajectoryRun& run : runs)
    EXPECT_NE(run.covariances, "constant");
  const double of_exact = runs[0].score.nees_per_degree;
  EXPECT_GT(of_exact, 0.0);
  alone.recording.quality = "B";
  alone.recording.truth_sd = {0.1, 0.01};
  EXPECT_LT(trajectoriesOf({alone})[0].score.nees_per_degree, of_exact);
  alone.recording.quality = "C";
  runs = trajectoriesOf({alone});
  EXPECT_TRUE(std::isnan(runs[0].score.nees_per_degree));
  EXPECT_TRUE(std::isnan(runs[0].score.nees_per_degree_of_last));
  EXPECT_GT(runs[0].score.ate, 0.0);
}

TEST(Trajectories, DrivesAreTheSameEachTimeAndMoveALittle)
{
  for (const std::string& name : driveNames()) {
    const Recording drive = makeDrive(name, 3, 100);
    ASSERT_EQ(drive.poses.size(), 100u);
    for (std::size_t k = 1; k < 100; ++k) {
      const Isometry3d step = drive.relativePose(k - 1, k);
      EXPECT_LT(step.translation().norm(), 0.75) << name << ' ' << k;
      EXPECT_LT(Eigen::AngleAxisd(step.linear()).angle(), 0.4) << name << ' ' << k;
    }
    const Eigen::Matrix3Xd scan = drive.read(50);
    EXPECT_GT(scan.cols(), 5000) << name;
    EXPECT_TRUE(scan == makeDrive(name, 3, 100).read(50)) << name;
  }
  EXPECT_THROW(makeDrive("boat", 1, 3), std::invalid_argument);
}

TEST_F(TrajectoriesCommand, GoesOnWhereItStopped)
{
  const std::string arguments =
      "--recordings office_floor --scans 3 --span 1 --output r/a.csv";
  const CommandResult first = run(arguments);
  EXPECT_EQ(first.exit_code, 0) << first.output;
  expectIn(first.output, "2 of 2 pairs");
  const std::string rows = contentOf(folder_ / "r/a.csv");
  expectIn(rows, "office_floor,exact,1,calibrated,closed-form,3,");
  expectIn(first.output, "\n  office_floor (exact), calibrated + closed-form  ");
  EXPECT_EQ(count("note: rows of a constant covariance are left out", first.output), 1);
  const CommandResult other = run("--recordings office_floor --scans 2 --span 1 "
                                  "--output r/a.csv");
  expectIn(other.output, "1 of 1 pairs");
  const CommandResult second = run(arguments + " --report");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(count("pairs", second.output), 0) << second.output;
  EXPECT_EQ(contentOf(folder_ / "r/a.csv"), rows);
  expectIn(contentOf(folder_ / "r/report.md"), "Trajectories");
}

TEST_F(TrajectoriesCommand, RegistersAgainIfAScanIsAnotherOne)
{
  const auto write = [this](const std::string& name, const std::string& text) {
    std::filesystem::create_directories(folder_ / "scans/wall");
    std::ofstream(folder_ / "scans/wall" / name) << text;
  };
  const auto writeScan = [&](const std::string& name, double height) {
    Eigen::Matrix3Xd points(3, 100);
    for (int k = 0; k < 100; ++k)
      points.col(k) << k % 10, k / 10, height * (k % 3);
    writeCloud(folder_ / "scans/wall" / name, points);
  };
  write("set.json",
        R"({"quality": "A", "accuracy_translation_m": 0.01,
            "accuracy_rotation_rad": 0.001, "lost_displacement_m": 1})");
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  writeScan("scan_0000.pcd", 0.1);
  writeScan("scan_0001.pcd", 0.1);
  const auto numRegistered = [this] {
    return count("1 of 1 pairs", run("scans --output a.csv").output);
  };
  EXPECT_EQ(numRegistered(), 1);
  EXPECT_EQ(numRegistered(), 0);
  writeScan("scan_0000.pcd", 0.2);
  EXPECT_EQ(numRegistered(), 1);
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(numRegistered(), 1);
  EXPECT_EQ(numRegistered(), 0);
}

TEST_F(TrajectoriesCommand, SaysWhatItCannotUse)
{
  for (const char* arguments : {"--recordings sea", "--scans 1", "--span 0", "a b"}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << ": " << result.output;
    EXPECT_TRUE(std::filesystem::is_empty(folder_)) << arguments;
  }
  expectIn(run("--recordings sea").output,
           "--recordings: there is no 'sea', but street corridor_loop office_floor");
  const CommandResult result = run("nowhere");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  expectIn(result.output, "nowhere");
}
