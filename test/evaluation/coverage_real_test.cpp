// Real scans as cases of the coverage study: recordings, and pairs.
#include "coverage/coverage_methods.h"
#include "coverage/coverage_real.h"
#include "evaluation/evaluate_tool.h"
#include "evaluation/paper_pairs.h"
#include "io/errors.h"
#include "simulate/simulate_helpers.h"
#include "study/named.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <utility>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
namespace fs = std::filesystem;

namespace {

constexpr char set_text[] =
    R"({"name": "hall", "quality": "B", "accuracy_translation_m": 0.003,
        "accuracy_rotation_rad": 0.002, "lost_displacement_m": 0.1})";

/** The 12 numbers of a 3 x 4 matrix, row by row, in the frame of JSON or as they are.
 */
std::string
textOf(const Isometry3d& pose, bool is_json = false)
{
  std::ostringstream text;
  text << std::setprecision(17);
  for (int row = 0; row < 3; ++row) {
    text << (is_json ? (row > 0 ? ",[" : "[[") : (row > 0 ? " " : ""));
    for (int column = 0; column < 4; ++column)
      text << (column > 0 ? (is_json ? "," : " ") : "") << pose(row, column);
    text << (is_json ? "]" : "");
  }
  return text.str() + (is_json ? "]" : "");
}

/** Pose of a LiDAR that walks through a room [m]. */
Isometry3d
poseOfScan(int scan)
{
  Isometry3d pose(Eigen::AngleAxisd(0.1 * scan, Vector3d(0.1, 0.0, 1.0).normalized()));
  pose.translation() << 0.2 * scan, 0.1, 1.2;
  return pose;
}

/** A folder with a recording of four scans, `hall`. */
class SequencesTest : public EvaluateTool {
protected:
  void
  SetUp() override
  {
    FolderTest::SetUp();
    set_ = folder_ / "hall";
    fs::create_directories(set_);
    writeFile(set_ / "set.json", set_text);
    auto sensor = simulator::defaultOptions("room").sensor;
    sensor.lidar.azimuth_step = 2.0;
    std::string poses;
    for (int scan = 0; scan < 4; ++scan) {
      scans_.push_back(simulator::scanScene(simulator::makeScene("room"),
                                            sensor,
                                            poseOfScan(scan),
                                            1,
                                            static_cast<std::uint32_t>(scan))
                           .points);
      writeCloud(set_ / ("scan_000" + std::to_string(scan) + ".pcd"), scans_.back());
      poses += textOf(poseOfScan(scan)) + '\n';
    }
    writeFile(set_ / "poses.txt", poses);
  }

  SequencePairs
  pairs(const SequenceOptions& options = SequenceOptions()) const
  {
    return {folder_.string(), options};
  }

  static Isometry3d
  relativePose(int target, int source)
  {
    return poseOfScan(target).inverse() * poseOfScan(source);
  }

  /** The error of the folder; empty if there is none. */
  std::string
  complaint(const SequenceOptions& options = SequenceOptions()) const
  {
    try {
      pairs(options).makeCase("hall", 1);
    }
    catch (const io::FileError& error) {
      return error.what();
    }
    return "";
  }

  /** Options that take the guess and the truth of a pair from a file. */
  SequenceOptions
  withRow(const Isometry3d& guess, const Isometry3d& truth) const
  {
    writeFile(folder_ / "rows.jsonl",
              R"({"set": "hall", "pair": 1, "nees": 3, "guess": )" +
                  textOf(guess, true) + ", \"truth\": " + textOf(truth, true) + "}\n");
    SequenceOptions options;
    options.rows_file = (folder_ / "rows.jsonl").string();
    return options;
  }

  CommandResult
  run(const std::string& arguments) const
  {
    return EvaluateTool::run("coverage --real . " + arguments);
  }

  fs::path set_;
  std::vector<Matrix3Xd> scans_;
};

class RealPairsTest : public FolderTest {};

/** A pair of 40 points with the source a half turn about z from the target. */
void
writePair(const fs::path& folder)
{
  fs::create_directories(folder / "pair");
  Random random(1, 0);
  Eigen::Matrix3Xd points(3, 40);
  for (auto point : points.colwise())
    point << 3.0 + random.normal(), random.normal(), 0.5;
  writeCloud(folder / "pair/source.pcd", points);
  writeCloud(folder / "pair/target.pcd", points);
  writeFile((folder / "pair/truth.txt").string(),
            "-1 0 0 0.5\n0 -1 0 0\n0 0 1 0\n0 0 0 1\n");
  writeFile((folder / "manifest.json").string(),
            R"([{"name": "pair",
            "files": {"source": "pair/source.pcd", "target": "pair/target.pcd",
                      "ground_truth": "pair/truth.txt"},
            "ground_truth_accuracy": {"translation_m": 0.3, "rotation_deg": 9.0},
            "suggested_prior_sigma": {"translation_m": 0.2, "rotation_rad": 0.1}}])");
}

} // namespace

TEST_F(SequencesTest, SourceIsTurnedAndTheTruthPutsItBack)
{
  const CoverageCase made = pairs().makeCase("hall", 1);
  const Matrix3Xd in_place = relativePose(1, 2) * scans_[2];
  ASSERT_EQ(made.source.cols(), in_place.cols());
  EXPECT_LT((made.truth * made.source - in_place).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((made.target - scans_[1]).cwiseAbs().maxCoeff(), 1e-5);
  const Isometry3d turn = made.truth.inverse() * relativePose(1, 2);
  EXPECT_NEAR(Eigen::AngleAxisd(turn.linear()).angle(), 0.5, 1e-9);
  EXPECT_NEAR(turn.translation().norm(), 0.5, 1e-9);
  EXPECT_LT((made.truth * made.sensor - relativePose(1, 2).translation()).norm(), 1e-9);
  EXPECT_EQ(made.prior_sd, PriorOptions().variance.cwiseSqrt());
  EXPECT_EQ(made.truth_sd.translation, 0.003);
  EXPECT_EQ(made.truth_sd.rotation, 0.002);
  EXPECT_EQ(made.lost_displacement, 0.1);
  EXPECT_EQ(made.seed, ChainOptions().seed);
}

TEST_F(SequencesTest, GuessesAreAsWideAsTheyShould)
{
  constexpr int num_guesses = 200;
  SequenceOptions options;
  options.guess_sd = {0.2, 0.05};
  const Isometry3d T_target_sensor = relativePose(1, 2);
  double sum = 0.0;
  for (options.seed = 1; options.seed <= num_guesses; ++options.seed) {
    const CoverageCase made = pairs(options).makeCase("hall", 1);
    const Eigen::Matrix4d guess = matrixOf(made.prior_mean) *
                                  made.truth.matrix().inverse() *
                                  T_target_sensor.matrix();
    const Vector3d shift = guess.topRightCorner<3, 1>() - T_target_sensor.translation();
    const Vector3d turn =
        logSO3(guess.topLeftCorner<3, 3>() * T_target_sensor.linear().transpose());
    sum += shift.squaredNorm() / (0.2 * 0.2) + turn.squaredNorm() / (0.05 * 0.05);
  }
  // Chi-square with 6 degrees of freedom: mean 6, variance 12; 4 standard errors.
  EXPECT_NEAR(sum / num_guesses, 6.0, 4.0 * std::sqrt(12.0 / num_guesses));
}

TEST_F(SequencesTest, PairsAreSpreadEvenly)
{
  using Pairs = std::vector<std::uint64_t>;
  SequenceOptions options;
  EXPECT_EQ(pairs().names(), std::vector<std::string>{"hall"});
  EXPECT_EQ(pairs().pairs("hall"), (Pairs{0, 1, 2}));
  options.max_pairs = 2;
  EXPECT_EQ(pairs(options).pairs("hall"), (Pairs{0, 2}));
  options.max_pairs = 1;
  EXPECT_EQ(pairs(options).pairs("hall"), (Pairs{0}));
  options.max_pairs = 0;
  options.step = 3;
  EXPECT_EQ(pairs(options).pairs("hall"), (Pairs{0}));
  EXPECT_LT((pairs(options).makeCase("hall", 0).target - scans_[0]).norm(), 1e-3);
  options.step = 4;
  EXPECT_EQ(pairs(options).pairs("hall"), Pairs());
}

TEST_F(SequencesTest, ConditionsTellGuessesApart)
{
  SequenceOptions other;
  other.seed = 2;
  EXPECT_EQ(pairs().condition("hall"), "B step 1 guess-sd 0.1 0.03 seed 1");
  EXPECT_NE(pairs().condition("hall"), pairs(other).condition("hall"));
  const Isometry3d none = Isometry3d::Identity();
  const std::string of_rows = pairs(withRow(none, none)).condition("hall");
  EXPECT_EQ(pairs(withRow(none, none)).condition("hall"), of_rows);
  EXPECT_NE(pairs(withRow(relativePose(1, 2), none)).condition("hall"), of_rows);
}

TEST_F(SequencesTest, RowsGiveGuessAndTruth)
{
  Isometry3d turn(Eigen::AngleAxisd(0.3, Vector3d::UnitX()));
  turn.translation() << 0.1, 0.2, 0.3;
  const Isometry3d truth = relativePose(1, 2) * turn.inverse();
  const Isometry3d guess = Eigen::Translation3d(0.0, 0.1, 0.0) * truth;
  const SequencePairs rows = pairs(withRow(guess, truth));
  EXPECT_EQ(rows.pairs("hall"), std::vector<std::uint64_t>{1});
  const CoverageCase made = rows.makeCase("hall", 1);
  EXPECT_LT((made.truth.matrix() - truth.matrix()).norm(), 1e-12);
  EXPECT_LT((matrixOf(made.prior_mean) - guess.matrix()).norm(), 1e-12);
  EXPECT_LT((made.source - turn * scans_[2]).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_F(SequencesTest, WhatIsWrongIsNamed)
{
  ASSERT_EQ(complaint(), "");
  const std::string poses = contentOf(set_ / "poses.txt");
  const auto expect = [this](const std::string& piece,
                             const SequenceOptions& options = SequenceOptions()) {
    expectIn(complaint(options), piece);
  };
  writeFile(set_ / "poses.txt", poses + textOf(poseOfScan(4)) + '\n');
  expect("poses.txt: there are 4 scans, but 5 lines");
  std::string fewer = poses;
  fewer.resize(poses.rfind('\n', poses.size() - 2) + 1);
  writeFile(set_ / "poses.txt", fewer);
  expect("poses.txt: there are 4 scans, but 3 lines");
  writeFile(set_ / "poses.txt", poses.substr(0, poses.rfind(' ')) + '\n');
  expect("poses.txt: line 4: has 11 numbers");
  writeFile(set_ / "poses.txt", "1 0 0 0 0 x\n");
  expect("poses.txt: line 1: 'x' is not a number");
  writeFile(set_ / "poses.txt", "1 0 0 0 0 1 0 0 0 0 2 0\n");
  expect("poses.txt: line 1: the upper left of the matrix is not a rotation");
  fs::remove(set_ / "poses.txt");
  expect("poses.txt: no such file");
  writeFile(set_ / "poses.txt", poses);

  writeFile(set_ / "set.json", R"({"quality": "A")");
  expect("set.json: broken JSON");
  writeFile(set_ / "set.json", R"({"quality": "A"})");
  expect("set.json: the key 'accuracy_translation_m' is missing");
  writeFile(set_ / "set.json", R"({"quality": "D"})");
  expect("set.json: quality is 'D'");
  writeFile(set_ / "set.json", set_text);

  SequenceOptions options = withRow(Isometry3d::Identity(), Isometry3d::Identity());
  const std::string row = contentOf(options.rows_file);
  for (const auto& [text, piece] :
       {std::pair<std::string, std::string>{row + row.substr(0, 50),
                                            "line 2: broken JSON"},
        {row + row, "line 2: pair 1 of hall is there twice"},
        {R"({"set": "x"})", "line 1: the key 'pair' is missing"},
        {R"({"set": "hall", "pair": -1})",
         "line 1: pair is '-1', but must be the number of a scan"},
        {R"({"set": "hall", "pair": 1, "guess": [[1]]})",
         "line 1: guess: has 1 numbers"}}) {
    writeFile(options.rows_file, text);
    expect("rows.jsonl: " + piece, options);
  }
  options.step = 3;
  writeFile(options.rows_file, row);
  expect("rows.jsonl: line 1: there is no pair 1 of hall", options);
  fs::resize_file(set_ / "scan_0002.pcd", 300);
  expect("scan_0002.pcd: ");
  fs::remove_all(set_);
  expect("has neither a manifest.json nor a folder with a set.json");
}

TEST_F(SequencesTest, TheCommandCountsLostPairs)
{
  const CommandResult result = run("--methods calibrated,gicp,icp --output a.csv");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  for (const char* piece :
       {"  lost  ", "\n  hall, B step 1 guess-sd 0.1 0.03 seed 1, calibrated  "})
    expectIn(result.output, piece);
  const Rows rows = rowsOf(folder_ / "a.csv");
  ASSERT_EQ(rows.size(), 10u);
  const auto field = [&rows](std::size_t row, const std::string& column) {
    const auto found = std::find(rows[0].begin(), rows[0].end(), column);
    return rows[row][static_cast<std::size_t>(found - rows[0].begin())];
  };
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const bool has_posterior = field(row, "method") == "calibrated";
    EXPECT_EQ(field(row, "lost_displacement_m"), "0.1");
    EXPECT_NE(field(row, "displacement_m"), "nan");
    EXPECT_EQ(field(row, "nees") != "nan", has_posterior) << row;
    if (has_posterior) {
      EXPECT_LT(std::stod(field(row, "displacement_m")), 0.1) << row;
    }
  }
  const CommandResult again = run("--methods calibrated,gicp,icp --output a.csv");
  EXPECT_EQ(count(" cases", again.output), 0) << again.output;
}

TEST_F(SequencesTest, RowsOfOtherInputsDoNotCount)
{
  const auto numRegistered = [this](const std::string& folder) {
    const CommandResult result =
        EvaluateTool::run("coverage --methods prior --output a.csv --real " + folder);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return count(" cases", result.output);
  };
  EXPECT_EQ(numRegistered("."), 3);
  EXPECT_EQ(numRegistered("."), 0);
  std::string poses = contentOf(set_ / "poses.txt");
  poses.replace(0, poses.find('\n'), textOf(poseOfScan(7)));
  writeFile(set_ / "poses.txt", poses);
  EXPECT_EQ(numRegistered("."), 1);
  std::string set = set_text;
  set.replace(set.find("0.003"), 5, "0.005");
  writeFile(set_ / "set.json", set);
  EXPECT_EQ(numRegistered("."), 3);
  fs::create_directories(folder_ / "other");
  fs::copy(set_, folder_ / "other" / "hall", fs::copy_options::recursive);
  EXPECT_EQ(numRegistered("other"), 0) << "the same inputs";
  writeCloud(folder_ / "other" / "hall" / "scan_0003.pcd", scans_[2]);
  EXPECT_EQ(numRegistered("other"), 1);
  EXPECT_EQ(numRegistered("."), 1);
}

TEST_F(SequencesTest, ScansThatAreLeftOutAreTold)
{
  fs::create_directories(folder_ / "yard");
  fs::copy(set_ / "scan_0000.pcd", folder_ / "yard");
  const std::string output = run("--methods prior --output a.csv").output;
  expectIn(output, "yard: note: has no set.json, so its scans are left out");
}

TEST_F(SequencesTest, BadOptionsOfTheCommandExitWithTwo)
{
  for (const char* arguments : {"--step 0",
                                "--pairs -1",
                                "--guess-sd 0.1",
                                "--guess-sd 0.1,-0.1",
                                "--guess-sd nan,0.1",
                                "--seeds 3",
                                "--conditions same",
                                "--scenes nowhere",
                                "--rows x --guess-sd 0.1,0.03",
                                "--rows x --first-seed 1",
                                "--real '' --rows x",
                                "--real '' --step 2"}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << ": " << result.output;
  }
  EXPECT_EQ(run("--rows missing").exit_code, 3);
}

TEST_F(RealPairsTest, RealPosesAreDrawnFromThePrior)
{
  writePair(folder_);
  const std::vector<ManifestEntry> pairs = readManifest(folder_.string());
  ASSERT_EQ(namesOf(pairs), std::vector<std::string>{"pair"});
  const auto makeCase = [&](std::uint64_t seed) {
    return makeRealCase(folder_.string(), pairs[0], seed);
  };
  constexpr int num_cases = 400;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= num_cases; ++seed) {
    const CoverageCase made = makeCase(seed);
    sum += priorOf(made)
               .deviation(poseOf(made.truth.matrix()))
               .cwiseQuotient(made.prior_sd)
               .squaredNorm();
    // The file's points, turned by half a turn and shifted.
    ASSERT_EQ(made.source.cols(), 40);
    const Vector3d moved = made.truth * Vector3d(made.source.rowwise().mean());
    const Vector3d target = made.target.rowwise().mean();
    EXPECT_LT((moved - Vector3d(0.5 - target.x(), -target.y(), 0.5)).norm(), 1e-6);
  }
  // Chi-square with 6 degrees of freedom: mean 6, variance 12; 4 standard errors.
  EXPECT_NEAR(sum / num_cases, 6.0, 4.0 * std::sqrt(12.0 / num_cases));
  const CoverageCase made = makeCase(1);
  EXPECT_NEAR(made.truth_sd.translation, 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(
      made.truth_sd.rotation, 9.0 * std::acos(-1.0) / 180.0 / std::sqrt(3.0), 1e-12);
  EXPECT_EQ(made.source, makeCase(1).source);
}

TEST_F(RealPairsTest, BadFoldersOfPairsAreNamed)
{
  EXPECT_THROW(readManifest((folder_ / "none").string()), io::FileError);
  const auto refuseManifest = [&](const std::string& manifest) {
    writeFile((folder_ / "manifest.json").string(), manifest);
    EXPECT_THROW(readManifest(folder_.string()), io::FileError) << manifest;
  };
  refuseManifest(R"([{"name": "pair"}])");
  writePair(folder_);
  const std::string good = contentOf(folder_ / "manifest.json");
  const std::string pair = good.substr(1, good.size() - 2);
  refuseManifest('[' + pair + ',' + pair + ']');
  refuseManifest(
      boost::replace_all_copy(good, "\"name\": \"pair\"", "\"name\": \"a/b\""));
  refuseManifest(boost::replace_all_copy(good, "0.2", "0"));
  refuseManifest(boost::replace_all_copy(good, "0.2", "-0.2"));
  writePair(folder_);
  writeFile((folder_ / "pair/truth.txt").string(), "1 0 0 0\n0 1 0 0\n");
  EXPECT_THROW(makeRealCase(folder_.string(), readManifest(folder_.string())[0], 1),
               io::FileError);
}
