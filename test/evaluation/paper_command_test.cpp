// The sub-commands of the paper's evaluation, run as a user would.
#include "evaluation/csv_rows.h"
#include "evaluation/evaluate_tool.h"
#include "evaluation/paper_pairs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

namespace fs = std::filesystem;

namespace {

/** The rows without the column of seconds, which differ from run to run. */
Rows
withoutSeconds(Rows rows)
{
  const auto header = rows.front();
  const auto column = std::find(header.begin(), header.end(), "seconds");
  if (column != header.end())
    for (auto& row : rows)
      row.erase(row.begin() + (column - header.begin()));
  return rows;
}

class PaperCommand : public EvaluateTool {
protected:
  fs::path
  runsOfIcp() const
  {
    for (const auto& entry : fs::directory_iterator(folder_ / "out"))
      if (entry.path().filename().string().rfind("monte_carlo_good_", 0) == 0)
        return entry.path();
    return {};
  }
};

constexpr char quick[] = "--quick --no-report --pairs mug --points 60 --data "
                         "'" BAYESIAN_ICP_DATA_DIR "' --output ";

constexpr char small[] =
    " --output out --quick --repeats 2 --baseline-runs 10 --no-report";

} // namespace

TEST_F(PaperCommand, BrokenPairsAreSkippedAndTheExitCodeSaysSo)
{
  writeScanPair(folder_, "good");
  writeScanPair(folder_, "broken");
  std::ofstream(folder_ / "broken/T_target_source.txt") << "1 0 0";
  const CommandResult result =
      run(std::string("distribution --data . --pairs broken,good,missing") + small);
  EXPECT_EQ(result.exit_code, 3) << result.output;
  for (const char* piece : {"pair broken is skipped: ./broken/T_target_source.txt",
                            "pair missing is skipped: ./missing/source.pcd",
                            "2 pairs were skipped",
                            "medians of the runs of",
                            "\n  good, online-icp "})
    expectIn(result.output, piece);
  const Rows rows = rowsOf(folder_ / "out/distribution.csv");
  ASSERT_GT(rows.size(), 2u);
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_EQ(rows[i][1], "good");
}

TEST_F(PaperCommand, ThreadsMakeNoDifference)
{
  writeScanPair(folder_, "good");
  const std::string command = std::string("distribution --data . --pairs good") + small;
  ASSERT_EQ(run(command + " --threads 1").exit_code, 0);
  const std::string icp_rows = contentOf(runsOfIcp());
  const Rows rows = rowsOf(folder_ / "out/distribution.csv");
  fs::remove_all(folder_ / "out");
  ASSERT_EQ(run(command + " --threads 3").exit_code, 0);
  EXPECT_EQ(contentOf(runsOfIcp()), icp_rows);
  EXPECT_TRUE(withoutSeconds(rowsOf(folder_ / "out/distribution.csv")) ==
              withoutSeconds(rows));
}

TEST_F(PaperCommand, WritesWhatTheReportNeeds)
{
  writeScanPair(folder_, "good");
  fs::create_directories(folder_ / "my data");
  writeScanPair(folder_ / "my data", "good");
  const CommandResult result =
      run(std::string("distribution --data 'my data' --pairs good") + small);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_FALSE(fs::exists(folder_ / "out/report.md"));
  const Rows baseline = rowsOf(folder_ / "out/baseline.csv");
  ASSERT_EQ(baseline.size(), 2u);
  EXPECT_EQ(baseline[1][0], "good");
  EXPECT_EQ(baseline[1][2], "300"); // points of the target
  EXPECT_EQ(baseline[1][3], "10");
  std::map<std::string, int> draws, points;
  for (const auto& row : rowsOf(folder_ / "out/draws_good.csv"))
    ++draws[row.front()];
  for (const auto& row : rowsOf(folder_ / "out/points_good.csv"))
    ++points[row.front()];
  EXPECT_EQ(draws["baseline"], 10);
  EXPECT_EQ(draws["exact"], 2000);
  for (const char* cloud : {"target", "before", "bayesian-icp", "calibrated", "truth"})
    EXPECT_GT(points[cloud], 100) << cloud;
  const std::string key = rowsOf(folder_ / "out/distribution.csv")[1][0];
  const std::string record = contentOf(folder_ / "out/study.json");
  for (const std::string& piece :
       {"\"key\": \"" + key + "\"",
        std::string("\"seeds\": 2"),
        std::string("evaluate distribution --data 'my data' --pairs good --output")})
    expectIn(record, piece);
}

TEST_F(PaperCommand, SaysWhatTheReportNeedsAndMakesItLater)
{
  writeScanPair(folder_, "good");
  const std::string command = "runtime --pairs good --data . --output out --quick";
  const std::string without = "PCL_BAYESIAN_ICP_PYTHON=/nowhere";
  const CommandResult result = run(command, without);
  EXPECT_EQ(result.exit_code, 3) << result.output;
  expectIn(result.output,
           "The CSV files are complete. The report needs python3-pandas and "
           "python3-matplotlib; then run: pcl_bayesian_icp_evaluate report out\n");
  expectIn(result.output, "seconds per 1000 draws");
  EXPECT_EQ(run("report out", without).exit_code, 3);
  EXPECT_FALSE(fs::exists(folder_ / "out/report.md"));
  const CommandResult later = run("report out");
  EXPECT_EQ(later.exit_code, 0) << later.output;
  EXPECT_EQ(later.output, "out/report.html\n");
  EXPECT_EQ(count("## Run time\n", contentOf(folder_ / "out/report.md")), 1);
}

TEST_F(PaperCommand, RuntimeIsKeptAndShown)
{
  const CommandResult first = run("runtime --repeats 2 " + std::string(quick) + "out");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const std::string rows = contentOf(folder_ / "out/runtime.csv");
  // Three presets on 1, 2 and 4 threads, twice.
  EXPECT_EQ(count("\n", rows), 1 + 3 * 3 * 2);
  for (const char* text : {"\n  exact, 1 threads ", "\n  calibrated, 4 threads "})
    expectIn(first.output, text);
  const CommandResult second = run("runtime --repeats 2 " + std::string(quick) + "out");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(contentOf(folder_ / "out/runtime.csv"), rows);
}

TEST_F(PaperCommand, AccuracyIsKeptAndShown)
{
  const CommandResult first = run("accuracy " + std::string(quick) + "out");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const std::string rows = contentOf(folder_ / "out/accuracy.csv");
  // Six methods from five starts.
  EXPECT_EQ(count("\n", rows), 1 + 6 * 5);
  for (const char* method : {"paper", "exact", "calibrated", "sgd-icp", "icp"})
    expectIn(first.output, std::string("\n  mug, ") + method + ' ');
  // Half of it, then the same again: only what is missing is made, and it is the same.
  fs::resize_file(folder_ / "out/accuracy.csv", rows.size() / 2);
  const CommandResult second =
      run("accuracy " + std::string(quick) + "out --threads 1");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(contentOf(folder_ / "out/accuracy.csv"), rows);
}
