// The sub-command `sbc`, run as a user would.
#include "support/command_helpers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace fs = std::filesystem;

namespace {

class SbcCommand : public FolderTest {
protected:
  CommandResult
  run(const std::string& arguments) const
  {
    return runShell("cd '" + folder_.string() +
                    "' && '" BAYESIAN_ICP_EVALUATE "' sbc " + arguments);
  }
};

} // namespace

TEST_F(SbcCommand, TellsRanksThatAreNotUniform)
{
  std::ofstream file(folder_ / "a.csv");
  file << "sampler,seed,valid,rank_x,rank_y,rank_z,rank_roll,rank_pitch,rank_yaw\n";
  // Ten runs in one bin: a statistic of 90.
  for (int seed = 1; seed <= 10; ++seed)
    file << "calibrated," << seed << ",1,0,10,20,30,40,99\n";
  file.close();
  const CommandResult result = run("--sampler calibrated --runs 10 --output a.csv");
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("NOT UNIFORM"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("90.0"), std::string::npos) << result.output;
}

TEST_F(SbcCommand, BadOptionsExitWithTwo)
{
  for (const char* arguments : {"--sampler guessing",
                                "--runs 0",
                                "--runs x",
                                "--seed -1",
                                "--threads 1000",
                                "--output ''",
                                "word"}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << ": " << result.output;
    EXPECT_TRUE(fs::is_empty(folder_)) << arguments;
  }
}

TEST_F(SbcCommand, BadFilesExitWithThree)
{
  std::ofstream(folder_ / "other.csv") << "x,y\n";
  EXPECT_EQ(run("--runs 1 --output other.csv").exit_code, 3);
  std::ofstream(folder_ / "rank.csv")
      << "sampler,seed,valid,rank_x,rank_y,rank_z,rank_roll,rank_pitch,rank_yaw\n"
         "calibrated,1,1,0,10,20,30,40,100\n";
  EXPECT_EQ(run("--runs 1 --output rank.csv").exit_code, 3);
}
