// The report of the paper's evaluation, made as a user would.
#include "evaluation/csv_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace {

/** Mean of a column over the rows of a pair and a method. */
double
meanOf(const Rows& rows,
       const std::string& column,
       const std::string& pair,
       const std::string& method)
{
  const auto& header = rows.front();
  const auto k = static_cast<std::size_t>(
      std::find(header.begin(), header.end(), column) - header.begin());
  double sum = 0.0, size = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (rows[i][1] == pair && rows[i][2] == method) {
      sum += std::stod(rows[i].at(k));
      size += 1.0;
    }
  return sum / size;
}

/** The cells of the first row of this name below a caption. */
std::vector<std::string>
cellsOf(const std::string& markdown,
        const std::string& caption,
        const std::string& name)
{
  const std::size_t table = markdown.find(caption);
  const std::size_t begin = markdown.find("\n| " + name + " |", table);
  if (table == std::string::npos || begin == std::string::npos)
    return {};
  std::istringstream line(
      markdown.substr(begin + 3, markdown.find('\n', begin + 1) - begin - 3));
  std::vector<std::string> cells;
  for (std::string cell; std::getline(line, cell, '|');)
    cells.push_back(cell.substr(cell.find_first_not_of(' ')));
  return cells;
}

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
  run() const
  {
    return runShell("cd '" + folder_.string() +
                    "' && '" BAYESIAN_ICP_EVALUATE
                    "' paper --quick --data '" BAYESIAN_ICP_DATA_DIR "' --output out");
  }

  const std::filesystem::path folder_ = BAYESIAN_ICP_REPORT_DIR;
};

} // namespace

/** The report as CI makes it: its tables are those of the files, and its figures are in
 * it. */
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
  for (const char* object :
       {"bowl", "can", "mug_hidden_handle", "table_top", "mug", "table"}) {
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

  // Table I: the paper's numbers, and ours as they are in the file.
  const Rows rows = rowsOf(folder_ / "out/distribution.csv");
  const auto can = cellsOf(markdown, "KL(baseline ‖ method) of yaw", "can");
  ASSERT_EQ(can.size(), 11u) << markdown;
  EXPECT_EQ(can[1], "6.620 ± 3.251 ");
  EXPECT_EQ(can[2], "32.955 ");
  EXPECT_EQ(can[3], "Bayesian ICP ");
  // Three decimals are shown.
  EXPECT_NEAR(std::stod(can[4]), meanOf(rows, "kl_yaw", "can", "bayesian-icp"), 6e-4);
  EXPECT_NEAR(std::stod(can[5]), meanOf(rows, "kl_yaw", "can", "exact"), 6e-4);
  const auto bowl = cellsOf(markdown, "bowl: KL(baseline ‖ method)", "Bayesian ICP");
  ASSERT_EQ(bowl.size(), 10u);
  EXPECT_NEAR(std::stod(bowl[1]), meanOf(rows, "kl_x", "bowl", "bayesian-icp"), 6e-4);

  // All is there: nothing is made again, and the report says the same.
  const CommandResult again = run();
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(count(" runs\n", again.output), 0) << again.output;
  EXPECT_EQ(contentOf(folder_ / "out/report.md"), markdown);
}
