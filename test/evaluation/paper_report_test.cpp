// The report of the paper's evaluation, made as a user would.
#include "evaluation/csv_rows.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

/** The report stays in the build folder, to be looked at. */
class PaperReport : public testing::Test {
protected:
  void
  SetUp() override
  {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }

  CommandResult
  run(const std::string& options = "") const
  {
    return runShell(
        "cd '" + folder_.string() +
        "' && '" BAYESIAN_ICP_EVALUATE
        "' paper --quick --pairs can,table_top --baseline-runs 12 --points 100"
        " --repeats 2 --data '" BAYESIAN_ICP_DATA_DIR "' --output out " +
        options);
  }

  const std::filesystem::path folder_ = BAYESIAN_ICP_REPORT_DIR;
};

} // namespace

/** The report as CI makes it, with all sections and figures. */
TEST_F(PaperReport, QuickOneIsComplete)
{
  const CommandResult result = run();
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const std::string markdown = contentOf(folder_ / "out/report.md");
  const std::string html = contentOf(folder_ / "out/report.html");
  for (const char* title : {"Distribution (Table I)",
                            "Number of draws",
                            "Burn-in",
                            "Run time",
                            "Accuracy",
                            "How to repeat it"}) {
    EXPECT_EQ(count(std::string("## ") + title + "\n", markdown), 1) << title;
    EXPECT_EQ(count(std::string("<h2>") + title + "</h2>", html), 1) << title;
  }
  std::vector<std::string> figures = {
      "divergences", "samples", "burn_in", "runtime", "accuracy"};
  for (const char* object : {"can", "table_top"}) {
    figures.push_back(std::string("densities_") + object);
    figures.push_back(std::string("clouds_") + object);
  }
  for (const std::string& figure : figures) {
    EXPECT_EQ(count("](" + figure + ".svg)", markdown), 1) << figure;
    EXPECT_EQ(contentOf(folder_ / "out" / (figure + ".png")).substr(1, 3), "PNG");
  }
  const int num_figures = static_cast<int>(figures.size());
  EXPECT_EQ(count("<img ", html), num_figures);
  EXPECT_EQ(count("src=\"data:image/svg+xml;base64,", html), num_figures);
  EXPECT_EQ(count("src=", html), num_figures);
  EXPECT_EQ(count("<script", html) + count("@import", html), 0);

  // All is there: nothing is made again, and the report stays.
  const CommandResult again = run("--no-report");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(count(" runs\n", again.output), 0) << again.output;
  EXPECT_EQ(contentOf(folder_ / "out/report.md"), markdown);
}
