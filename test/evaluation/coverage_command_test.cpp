// The sub-command `coverage`, run as a user would.
#include "support/command_helpers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace fs = std::filesystem;

namespace {

class CoverageCommand : public FolderTest {
protected:
  CommandResult
  run(const std::string& arguments, const std::string& environment = "") const
  {
    return runShell("cd '" + folder_.string() + "' && " + environment +
                    " '" BAYESIAN_ICP_EVALUATE "' coverage " + arguments);
  }
};

} // namespace

TEST_F(CoverageCommand, RunsOnceAndMakesTheReport)
{
  const std::string arguments = "--quick --methods prior --output \"re'sults/a.csv\"";
  const CommandResult first = run(arguments);
  EXPECT_EQ(first.exit_code, 0) << first.output;
  EXPECT_NE(first.output.find("6 of 6 cases"), std::string::npos) << first.output;
  const std::string rows = contentOf(folder_ / "re'sults/a.csv");
  const CommandResult second = run(arguments + " --report");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(second.output.find(" cases"), std::string::npos) << second.output;
  EXPECT_EQ(contentOf(folder_ / "re'sults/a.csv"), rows);
  for (const char* name : {"a_regions", "a_pit", "a_anees"}) {
    const fs::path plot = folder_ / "re'sults" / name;
    EXPECT_EQ(contentOf(plot.string() + ".png").substr(1, 3), "PNG");
    EXPECT_NE(contentOf(plot.string() + ".svg").find("</svg>"), std::string::npos);
  }
}

TEST_F(CoverageCommand, RunsScenesWithTheirOwnConditions)
{
  const CommandResult result = run("--scenes street,tool --conditions lidar16,same "
                                   "--seeds 1 --methods prior --output a.csv");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("2 of 2 cases"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("street, lidar16\n"), std::string::npos);
  EXPECT_NE(result.output.find("tool, same\n"), std::string::npos);
}

TEST_F(CoverageCommand, BadOptionsExitWithTwo)
{
  for (const char* arguments : {"--scenes nowhere",
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
                                "--real . --conditions same"}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << ": " << result.output;
    EXPECT_TRUE(fs::is_empty(folder_)) << arguments;
  }
}

TEST_F(CoverageCommand, BadFilesExitWithThree)
{
  std::ofstream(folder_ / "other.csv") << "x,y\n";
  for (const char* arguments :
       {"--quick --methods prior --output other.csv", "--real missing"}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 3) << arguments << ": " << result.output;
  }
}
