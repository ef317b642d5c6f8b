// The experiments `runtime` and `accuracy`: rows that are kept, and medians of
// them.
#include "geometry/twist.h"
#include "paper/accuracy_methods.h"
#include "paper/paper_experiment.h"
#include "support/command_helpers.h"
#include "support/test_support.h"

#include <algorithm>
#include <cmath>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

namespace fs = std::filesystem;

namespace {

constexpr char quick[] =
    "--quick --no-report --pairs mug --points 60 --repeats 2 --data "
    "'" BAYESIAN_ICP_DATA_DIR "' --output ";

class PaperExperiments : public FolderTest {
protected:
  CommandResult
  run(const std::string& arguments) const
  {
    return runShell("cd '" + folder_.string() + "' && '" BAYESIAN_ICP_EVALUATE "' " +
                    arguments);
  }

  static std::size_t
  numLines(const std::string& text)
  {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
};

/** A corner of three walls, seen twice: one pose, which all methods find from nearby.
 */
ScanPair
cornerPair()
{
  Random random(12, 0);
  ScanPair pair;
  pair.name = "corner";
  const auto makeScan = [&random](Eigen::Index size) {
    Eigen::Matrix3Xd points(3, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      for (int k = 0; k < 3; ++k)
        points(k, i) = 0.4 * random.uniform();
      points(i % 3, i) = 0.0;
    }
    return points;
  };
  Vector6d truth;
  truth << 0.02, -0.01, 0.03, 0.02, -0.03, 0.04;
  pair.truth = isometryOf(truth);
  pair.source = makeScan(900);
  pair.target = pair.truth * makeScan(9000);
  return pair;
}

} // namespace

TEST_F(PaperExperiments, RuntimeIsKeptAndShown)
{
  const CommandResult first = run("runtime " + std::string(quick) + "out");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const std::string rows = contentOf(folder_ / "out/runtime.csv");
  // Three presets on 1, 2 and 4 threads, twice.
  EXPECT_EQ(numLines(rows), 1u + 3u * 3u * 2u);
  for (const char* text : {"\n  exact, 1 threads ", "\n  calibrated, 4 threads "})
    EXPECT_NE(first.output.find(text), std::string::npos) << first.output;
  const CommandResult second = run("runtime " + std::string(quick) + "out");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(contentOf(folder_ / "out/runtime.csv"), rows);
}

TEST_F(PaperExperiments, AccuracyIsKeptShownAndNamesSkippedPairs)
{
  const CommandResult first = run("accuracy " + std::string(quick) + "out");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const std::string rows = contentOf(folder_ / "out/accuracy.csv");
  EXPECT_EQ(numLines(rows), 1u + 5u * accuracyMethods().size());
  for (const AccuracyMethod& method : accuracyMethods())
    EXPECT_NE(first.output.find("\n  mug, " + method.name + ' '), std::string::npos)
        << first.output;
  // Half of it, then the same again: only what is missing is made, and it is the same.
  fs::resize_file(folder_ / "out/accuracy.csv", rows.size() / 2);
  const CommandResult second =
      run("accuracy " + std::string(quick) + "out --threads 1");
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(contentOf(folder_ / "out/accuracy.csv"), rows);
  std::string with_a_missing_pair = quick;
  with_a_missing_pair.replace(with_a_missing_pair.find("mug"), 3, "mug,nothing");
  const CommandResult third = run("accuracy " + with_a_missing_pair + "out");
  EXPECT_EQ(third.exit_code, 3) << third.output;
  EXPECT_NE(third.output.find("nothing"), std::string::npos) << third.output;
  EXPECT_EQ(contentOf(folder_ / "out/accuracy.csv"), rows);
}

TEST_F(PaperExperiments, BadFilesAndOptionsAreNamed)
{
  for (const char* command : {"runtime", "accuracy"}) {
    const std::string name = std::string(command) + ".csv";
    std::ofstream(folder_ / name) << "x,y\n";
    const CommandResult other = run(command + (" " + std::string(quick)) + ".");
    EXPECT_EQ(other.exit_code, 3) << other.output;
    EXPECT_NE(other.output.find(name), std::string::npos) << other.output;
    EXPECT_EQ(run(std::string(command) + " --repeats 0").exit_code, 2);
    EXPECT_EQ(run(std::string(command) + " --help").exit_code, 0);
  }
}

TEST(AccuracyMethods, FindThePoseFromNearby)
{
  const ScanPair pair = cornerPair();
  const PaperProblem problem(pair);
  const Vector6d truth = poseOf(pair.truth.matrix());
  // The posterior at the paper's scale has deviations of 1 / sqrt(6000) m, and as much
  // over the size of the corner as an angle: three of them, which is far more than the
  // others need. The chain of preset paper is spread over 0.15 m by its step size alone
  // (alpha N / 4). Starts are farther off than all of that.
  const auto bound = [](const std::string& name) {
    return name == "paper" ? 0.15 : 3.0 / std::sqrt(6000.0);
  };
  AccuracyStart start;
  start.pose = truth + 0.1 * Vector6d::Ones();
  for (const AccuracyMethod& method : accuracyMethods()) {
    const AccuracyEstimate estimate = method.run(problem, start);
    ASSERT_TRUE(estimate.pose.allFinite()) << method.name << ' ' << estimate.status;
    const Vector6d error = estimate.pose - truth;
    EXPECT_LT(error.head<3>().norm(), bound(method.name)) << method.name;
    EXPECT_LT(error.tail<3>().norm(), bound(method.name) / 0.4) << method.name;
  }
}
