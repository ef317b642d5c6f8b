// The sub-commands that are not the paper's: what they print and make, and what they
// refuse; bad options and files of all.
#include "evaluation/evaluate_tool.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

class EvaluateCommands : public EvaluateTool {};

constexpr char rank_header[] =
    "sampler,seed,valid,rank_x,rank_y,rank_z,rank_roll,rank_pitch,rank_yaw,"
    "version\n";

constexpr char last_ranks[] = "40,99," BAYESIAN_ICP_VERSION "\n";

/** Command lines of a sub-command. */
using CommandLines = std::pair<std::string, std::vector<std::string>>;

} // namespace

TEST_F(EvaluateCommands, HasAVersion)
{
  const CommandResult result = run("--version");
  EXPECT_EQ(result.exit_code, 0);
  expectIn(result.output, "pcl_bayesian_icp_evaluate 0.");
}

TEST_F(EvaluateCommands, CoverageRunsOnceAndMakesTheReport)
{
  const std::string command =
      "coverage --quick --methods prior --output \"re'sults/a.csv\"";
  const CommandResult first = run(command);
  EXPECT_EQ(first.exit_code, 0) << first.output;
  expectIn(first.output, "6 of 6 cases");
  const std::string rows = contentOf(folder_ / "re'sults/a.csv");
  const CommandResult second = run(command + " --report");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(count(" cases", second.output), 0) << second.output;
  EXPECT_EQ(contentOf(folder_ / "re'sults/a.csv"), rows);
  for (const char* name : {"a_regions", "a_pit", "a_anees"}) {
    const fs::path plot = folder_ / "re'sults" / name;
    EXPECT_EQ(contentOf(plot.string() + ".png").substr(1, 3), "PNG");
    expectIn(contentOf(plot.string() + ".svg"), "</svg>");
  }
}

TEST_F(EvaluateCommands, CoverageRunsScenesWithTheirOwnConditions)
{
  const CommandResult result =
      run("coverage --scenes street,tool --conditions lidar16,same --seeds 1 --methods "
          "prior --output a.csv");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  for (const char* piece :
       {"2 of 2 cases", "\n  street, lidar16, prior ", "\n  tool, same, prior "})
    expectIn(result.output, piece);
}

TEST_F(EvaluateCommands, WhatIsAskedForTwiceCountsOnce)
{
  const CommandResult coverage = run(
      "coverage --scenes tool --conditions same,same --seeds 3 --methods prior,prior "
      "--output a.csv");
  expectIn(coverage.output, "3 of 3 cases");
  expectIn(coverage.output, "\n  tool, same, prior     3  ");
  writeFile(folder_ / "b.csv",
            std::string(rank_header) + "exact-langevin,1,1,0,10,20,30," + last_ranks +
                "exact-metropolis,1,1,0,10,20,30," + last_ranks);
  const CommandResult ranks =
      run("sbc --sampler exact-langevin,exact --runs 1 --output b.csv");
  EXPECT_EQ(count("\n  exact-langevin ", ranks.output), 1) << ranks.output;
}

TEST_F(EvaluateCommands, SamplersAreComparedWithOneGoldStandardEach)
{
  const auto numRuns = [this](const std::string& arguments, int exit_code) {
    const CommandResult result = run(
        "samplers --quick --samplers exact --seeds 1 --cells 0.005:300 --output a.csv "
        "--data '" BAYESIAN_ICP_DATA_DIR "' " +
        arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    EXPECT_EQ(count("\n  can, sigma 0.005 m, N 300, exact     1  ", result.output), 1)
        << result.output;
    return rowsOf(folder_ / "a.csv").size() - 1;
  };
  EXPECT_EQ(numRuns("--points 100 --gold-seconds 1e-3", 1), 1u);
  EXPECT_EQ(numRuns("--points 100", 0), 2u) << "that one had not converged";
  EXPECT_EQ(numRuns("--points 200", 0), 3u);
  // Kept: no round of a gold standard is told again, unless its file is cut off.
  const std::string again =
      "samplers --quick --samplers exact --seeds 1 --cells 0.005:300 --output a.csv "
      "--points 200 --data '" BAYESIAN_ICP_DATA_DIR "'";
  EXPECT_EQ(count("KL between runs", run(again).output), 0);
  for (const auto& entry : fs::directory_iterator(folder_))
    if (entry.path().extension() == ".cbor")
      fs::resize_file(entry.path(), fs::file_size(entry.path()) - 1);
  EXPECT_GT(count("KL between runs", run(again).output), 0);
}

TEST_F(EvaluateCommands, SbcTellsRanksThatAreNotUniform)
{
  std::string rows = rank_header;
  // 50 runs in one bin: a statistic of 450.
  for (int seed = 1; seed <= 50; ++seed)
    rows += "calibrated," + std::to_string(seed) + ",1,0,10,20,30," + last_ranks;
  writeFile(folder_ / "a.csv", rows);
  const CommandResult result = run("sbc --sampler calibrated --runs 50 --output a.csv");
  EXPECT_EQ(result.exit_code, 1) << result.output;
  expectIn(result.output, "NOT UNIFORM");
  expectIn(result.output, "450.0");
}

TEST_F(EvaluateCommands, BadOptionsExitWithTwoAndLeaveNothing)
{
  const std::vector<std::string> of_paper = {"--baseline-runs 7",
                                             "--repeats 1",
                                             "--points -1",
                                             "--start-translation 0",
                                             "--start-rotation nan",
                                             "--threads 1000",
                                             "--output ''",
                                             "--quic",
                                             "word"};
  const std::vector<CommandLines> commands = {
      {"coverage",
       {"--scenes nowhere",
        "--conditions sunny",
        "--scenes street --conditions same",
        "--methods guessing",
        "--methods exact:plane:metropolis:0.01:300:500",
        "--methods exact:point-to-plane:metropolis:0.01:0:500",
        "--seeds 0",
        "--seeds x",
        "--first-seed -1",
        "--threads 1000",
        "--quic",
        "word",
        "--output ''",
        "--output cov.txt --report",
        "--real . --conditions same"}},
      {"sbc",
       {"--sampler guessing",
        "--runs 0",
        "--runs x",
        "--seed -1",
        "--threads 1000",
        "--output ''",
        "word"}},
      {"samplers",
       {"--samplers guessing",
        "--cells 1",
        "--cells 1:0",
        "--particles 7",
        "--particles 9.5",
        "--residual plane",
        "--gold-seconds 0",
        "--scenes ''",
        "--output ''"}},
      {"paper", of_paper},
      {"samples", of_paper},
      {"accuracy", {"--repeats 3", "--baseline-runs 100", "--start-rotation 1"}},
      {"runtime", {"--threads 2", "--start-translation 1"}},
      {"report", {"", "a b", "--quick"}}};
  for (const auto& [command, lines] : commands)
    for (const std::string& arguments : lines) {
      const CommandResult result = run(command + ' ' + arguments);
      EXPECT_EQ(result.exit_code, 2)
          << command << ' ' << arguments << ": " << result.output;
      EXPECT_TRUE(fs::is_empty(folder_)) << command << ' ' << arguments;
    }
}

TEST_F(EvaluateCommands, BadFilesExitWithThreeAndAreNamed)
{
  fs::create_directory(folder_ / "empty");
  writeFile(folder_ / "other.csv", "x,y\n");
  writeFile(folder_ / "accuracy.csv", "x,y\n");
  writeFile(folder_ / "rank.csv",
            rank_header + std::string("calibrated,1,1,0,100,20,30,") + last_ranks);
  writeFile(folder_ / "old.csv",
            rank_header + std::string("calibrated,1,1,0,10,20,30,40,99,0.0.9\n"));
  const std::vector<std::pair<std::string, std::string>> commands = {
      {"coverage --quick --methods prior --output other.csv", "other.csv"},
      {"coverage --real missing", "missing"},
      {"sbc --runs 1 --output other.csv", "other.csv"},
      {"sbc --runs 1 --output rank.csv", "rank.csv: bad line"},
      {"sbc --runs 1 --output old.csv",
       "old.csv: is not a file of results of version " BAYESIAN_ICP_VERSION},
      {"samplers --scenes can --output other.csv --data '" BAYESIAN_ICP_DATA_DIR "'",
       "other.csv"},
      {"samplers --scenes can,typo --output new.csv --data '" BAYESIAN_ICP_DATA_DIR "'",
       "typo"},
      {"accuracy --quick --pairs mug --output . --data '" BAYESIAN_ICP_DATA_DIR "'",
       "accuracy.csv"},
      {"paper --data nowhere", "nowhere"},
      {"report nowhere", "nowhere"},
      {"report empty", "no rows of a study"}};
  for (const auto& [command, piece] : commands) {
    const CommandResult result = run(command);
    EXPECT_EQ(result.exit_code, 3) << command << ": " << result.output;
    expectIn(result.output, piece);
  }
  EXPECT_FALSE(fs::exists(folder_ / "new.csv"));
}

TEST_F(EvaluateCommands, EachHasAHelp)
{
  for (const auto& [command, piece] : {std::pair("coverage", "--guess-sd"),
                                       std::pair("sbc", "--sampler"),
                                       std::pair("samplers", "--cells"),
                                       std::pair("burn-in", "--baseline-runs"),
                                       std::pair("report", "FOLDER")}) {
    const CommandResult result = run(std::string(command) + " --help");
    EXPECT_EQ(result.exit_code, 0) << command;
    expectIn(result.output, piece);
  }
}
