// Runs of Monte Carlo ICP on disk: the same bits, made once, never of other inputs.
#include "io/errors.h"
#include "paper/paper_baseline.h"
#include "support/command_helpers.h"
#include "support/test_support.h"

#include <algorithm>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

namespace fs = std::filesystem;

namespace {

class MonteCarloRuns : public FolderTest {
protected:
  MonteCarloRuns()
  {
    Random random(9, 0);
    source_ = test::randomPoints(random, 40);
    options_.half_range.setConstant(0.3);
    // More than one block, and a gate that some starts are beyond.
    options_.num_runs = 130;
    options_.max_iterations = 20;
    options_.max_distance = 0.1;
    options_.num_threads = 2;
  }

  std::string
  fileName() const
  {
    return monteCarloFile(
        (folder_ / "runs").string(), "cube", monteCarloKey(source_, source_, options_));
  }

  std::vector<MonteCarloIcpRun>
  kept() const
  {
    return keptMonteCarloRuns(
        source_, source_, options_, fileName(), [](const std::string&) {});
  }

  void
  expectThoseOf(const std::vector<MonteCarloIcpRun>& runs,
                const MonteCarloIcpOptions& options) const
  {
    const auto expected = monteCarloIcp(source_, source_, options);
    ASSERT_EQ(runs.size(), expected.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      EXPECT_EQ(runs[i].index, expected[i].index);
      EXPECT_EQ(runs[i].start, expected[i].start);
      EXPECT_EQ(runs[i].end, expected[i].end);
      EXPECT_EQ(runs[i].stop, expected[i].stop);
      EXPECT_EQ(runs[i].has_converged, expected[i].has_converged);
      EXPECT_EQ(runs[i].num_iterations, expected[i].num_iterations);
      EXPECT_EQ(runs[i].mean_squared_distance, expected[i].mean_squared_distance);
    }
  }

  Eigen::Matrix3Xd source_;
  MonteCarloIcpOptions options_;
};

std::size_t
numLines(const std::string& text)
{
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

} // namespace

TEST_F(MonteCarloRuns, AreBitForBitThoseOfMonteCarloIcp)
{
  const auto runs = kept();
  expectThoseOf(runs, options_);
  const std::string content = contentOf(fileName());
  EXPECT_EQ(numLines(content), 131u);
  // Read back, and not made again.
  expectThoseOf(kept(), options_);
  EXPECT_EQ(contentOf(fileName()), content);
  // Some starts are beyond the gate, and are no draws.
  const auto num_good = std::count_if(
      runs.begin(), runs.end(), [](const auto& run) { return run.has_converged; });
  EXPECT_GT(num_good, 0);
  EXPECT_LT(num_good, 130);
  const PoseMatrix ends = endsOf(runs);
  ASSERT_EQ(ends.rows(), num_good);
  const auto last = std::find_if(
      runs.rbegin(), runs.rend(), [](const auto& run) { return run.has_converged; });
  EXPECT_EQ(ends.bottomRows<1>().transpose(), last->end);
}

TEST_F(MonteCarloRuns, GoOnWhereTheyStopped)
{
  kept();
  const std::string content = contentOf(fileName());
  // Cut off in the middle of a row.
  fs::resize_file(fileName(), content.size() / 2);
  expectThoseOf(kept(), options_);
  EXPECT_EQ(contentOf(fileName()), content);
  // A part from the middle, then all: every row once.
  fs::remove(fileName());
  MonteCarloIcpOptions all = options_;
  options_.first_run = 50;
  options_.num_runs = 7;
  expectThoseOf(kept(), options_);
  EXPECT_EQ(numLines(contentOf(fileName())), 8u);
  options_ = all;
  expectThoseOf(kept(), all);
  EXPECT_EQ(numLines(contentOf(fileName())), 131u);
  // Fewer than there are.
  options_.num_runs = 10;
  expectThoseOf(kept(), options_);
}

TEST_F(MonteCarloRuns, OtherInputsAreAnotherFile)
{
  const auto key = [this] { return monteCarloKey(source_, source_, options_); };
  const MonteCarloIcpOptions before = options_;
  const std::uint64_t expected = key();
  options_.num_runs = 1;
  options_.first_run = 3;
  options_.num_threads = 1;
  EXPECT_EQ(key(), expected);
  const std::function<void()> changes[] = {[&] { options_.seed = 2; },
                                           [&] { options_.mean[5] = 1e-9; },
                                           [&] { options_.half_range[0] = 1.0; },
                                           [&] { options_.max_iterations = 21; },
                                           [&] { options_.max_distance = 0.2; },
                                           [&] { source_(0, 0) += 1e-12; }};
  for (const auto& change : changes) {
    options_ = before;
    change();
    EXPECT_NE(key(), expected);
  }
}

TEST_F(MonteCarloRuns, AnUnknownEndIsRefused)
{
  options_.num_runs = 3;
  kept();
  std::string content = contentOf(fileName());
  content.replace(content.rfind('_'), 1, "?");
  writeFile(fileName(), content);
  EXPECT_THROW(kept(), io::FileError);
}
