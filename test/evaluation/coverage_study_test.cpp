// The coverage study: rows that come back, runs that are not made again.
#include "coverage/coverage_study.h"
#include "evaluation/coverage_test_support.h"
#include "evaluation/csv_rows.h"
#include "io/errors.h"
#include "study/named.h"

#include <bayesian_icp/pipeline.h>

#include <gtest/gtest.h>

#include <atomic>
#include <new>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

namespace {

class CoverageStudyTest : public FolderTest {
protected:
  void
  SetUp() override
  {
    FolderTest::SetUp();
    file_ = (folder_ / "coverage.csv").string();
  }

  /** Two methods on \p num_cases cases; counts what is run. */
  CoverageStudy
  study(std::uint64_t num_cases, int num_threads)
  {
    CoverageStudy study;
    for (std::uint64_t seed = 1; seed <= num_cases; ++seed)
      study.cases.push_back({"scene", "condition", seed});
    study.make_case = [](const CoverageCaseName& name) {
      return rightPosterior(name.seed, 0).problem;
    };
    study.methods = {{"right",
                      [this](const CoverageCase& problem) {
                        ++num_runs_;
                        return rightPosterior(problem.seed, 0).result;
                      }},
                     {"bad", [this](const CoverageCase&) -> MethodResult {
                        ++num_runs_;
                        throw std::runtime_error("no, never");
                      }}};
    study.num_threads = num_threads;
    return study;
  }

  std::string file_;
  std::atomic<int> num_runs_ = 0;
};

} // namespace

TEST_F(CoverageStudyTest, GoesOnWhereItStopped)
{
  {
    CoverageFile results(file_);
    runCoverageStudy(study(5, 1), results);
    EXPECT_EQ(num_runs_, 10);
    runCoverageStudy(study(5, 1), results);
    EXPECT_EQ(num_runs_, 10);
  }
  const std::string complete = contentOf(file_);
  ASSERT_EQ(count("\n", complete), 11);
  CoverageFile results(file_);
  runCoverageStudy(study(6, 1), results);
  EXPECT_EQ(num_runs_, 12);
  const std::string content = contentOf(file_);
  EXPECT_EQ(count("\n", content), 13);
  EXPECT_EQ(content.substr(0, complete.size()), complete);
}

TEST_F(CoverageStudyTest, ARowOfOtherInputsIsReplaced)
{
  CoverageFile results(file_);
  CoverageStudy changed = study(2, 1);
  runCoverageStudy(changed, results);
  changed.cases[1].inputs = "other";
  runCoverageStudy(changed, results);
  EXPECT_EQ(num_runs_, 6);
  EXPECT_EQ(runsOf(changed, results)[2].inputs, "other");
}

TEST_F(CoverageStudyTest, AnExceptionOfAMethodIsAResult)
{
  CoverageFile results(file_);
  runCoverageStudy(study(1, 1), results);
  const CoverageRun* run = results.find({"scene", "condition", 1, "bad"});
  ASSERT_NE(run, nullptr);
  EXPECT_FALSE(run->score.is_valid);
  EXPECT_EQ(run->score.notes, "exception: no, never");
}

TEST_F(CoverageStudyTest, AnExceptionOfACaseEndsTheStudyAndKeepsTheRows)
{
  CoverageFile results(file_);
  CoverageStudy failing = study(6, 2);
  const auto make_case = failing.make_case;
  failing.make_case = [make_case](const CoverageCaseName& name) {
    if (name.seed == 6)
      throw io::FileError("cloud", "cannot be read");
    return make_case(name);
  };
  EXPECT_THROW(runCoverageStudy(failing, results), io::FileError);
  EXPECT_NE(results.find({"scene", "condition", 1, "right"}), nullptr);
  EXPECT_EQ(results.find({"scene", "condition", 6, "right"}), nullptr);
}

TEST_F(CoverageStudyTest, LackOfMemoryIsNoResult)
{
  CoverageFile results(file_);
  CoverageStudy failing = study(2, 2);
  failing.methods[0].run = [](const CoverageCase&) -> MethodResult {
    throw std::bad_alloc();
  };
  EXPECT_THROW(runCoverageStudy(failing, results), std::bad_alloc);
  EXPECT_EQ(count("\n", contentOf(file_)), 1) << "only the header";
}

TEST(CoverageSummary, HasEveryCellAndThePools)
{
  std::vector<CoverageRun> runs;
  for (const char* scene : {"box", "can"})
    for (const char* condition : {"same", "moved"})
      runs.push_back({{scene, condition, 1, "right"}, {}});
  for (const char* group : {"\n  box, same, right ",
                            "\n  can, moved, right ",
                            "\n  all scenes, moved, right  ",
                            "\n  all, right "})
    expectIn(summaryOf(runs), group);
  // A pool of one scene would be that scene again.
  runs.push_back({{"can", "other", 1, "right"}, {}});
  EXPECT_EQ(summaryOf(runs).find("all scenes, other"), std::string::npos);
}

TEST(CoverageSummary, TellsOfTenRuns)
{
  std::vector<CoverageRun> runs;
  for (std::uint64_t k = 0; k < 10; ++k) {
    CoverageScore& score = runs.emplace_back().score;
    score.is_valid = true;
    score.nees = k % 2 == 0 ? 6.0 : 12.0;
    score.region = (static_cast<double>(k) + 0.5) / 10.0;
    score.log_score = 2.0;
    score.energy_score = 0.5;
    score.translation_error = 1e-3 * static_cast<double>(k + 1);
    score.rotation_error = 0.1;
    score.displacement = 0.01;
    score.seconds = 0.25;
    score.num_queries = 1000;
    score.notes = k < 2 ? "flag:modes" : "";
    runs.back().name = {"can", "same", k, "a"};
  }
  // 5, 7, 9 and 10 of 10 regions are within the levels, and none is outside of them.
  EXPECT_EQ(
      summaryOf(runs),
      "  runs of       runs  valid  NEES/6  in 50 %  in 68 %  in 90 %  in 95 %  log p"
      "  energy  [mm]  [deg]  flagged   [s]  queries\n"
      "  can, same, a    10      1     1.5      0.5      0.7      0.9        1      2"
      "     0.5   5.5   5.73      0.2  0.25     1000\n");
  for (CoverageRun& run : runs)
    run.score.num_queries = -1;
  EXPECT_EQ(count("queries", summaryOf(runs)), 0);
}

TEST(CoverageSummary, TellsWhatIsLostFalselyDoubtedAndMissed)
{
  // NEES, displacement, flagged: good, an alarm, neither, bad but told, lost and
  // missed, without a result.
  std::vector<CoverageRun> runs(7);
  const double nees[] = {1.0, 16.8, 20.0, 28.0, 1.0, std::nan("")};
  const double displacement[] = {0.1, 0.1, 0.1, 0.1, 0.3, std::nan("")};
  const bool is_flagged[] = {false, true, false, true, false, false};
  for (std::size_t i = 0; i < 6; ++i) {
    CoverageScore& score = runs[i].score;
    score.nees = nees[i];
    score.displacement = displacement[i];
    score.is_valid = !std::isnan(nees[i]);
    score.notes = is_flagged[i] ? "prior_only=1;flag:misfit" : "no flag:here";
  }
  runs[6].score.displacement = 0.3; // a pose alone
  for (CoverageRun& run : runs) {
    run.score.lost_displacement = 0.2;
    run.name = {"hall", "A", 1, "a"};
  }
  EXPECT_EQ(
      summaryOf(runs),
      "  runs of     runs   valid    lost        NEES/6        flagged      alarms"
      "         misses\n"
      "  hall, A, a     7  0.7143  0.4286  2.742 (of 4)  0.3333 (of 6)  0.5 (of 2)"
      "  0.3333 (of 3)\n");
}

MethodResult
run(const std::string& name, const CoverageCase& problem)
{
  const std::vector<CoverageMethod> methods = coverageMethods();
  return timedResult(*findNamed(methods, name), problem);
}

/** What the library makes of a case's points with its prior and seed. */
PosteriorEstimate
estimateOf(const CoverageCase& problem, Options options)
{
  options.prior.mean = problem.prior_mean;
  options.prior.variance = problem.prior_sd.cwiseAbs2();
  options.prior.frame = PriorFrame::SourceCentroid;
  options.chains.seed = problem.seed;
  return estimatePosterior(problem.source,
                           KdTree(problem.target.cast<float>(), 1),
                           problem.prior_mean,
                           options);
}

TEST(CoverageMethods, PaperIsAlgorithm1WithThePriorOfTheCase)
{
  CoverageCase problem = rightPosterior(1, 0).problem;
  problem.prior_mean << 0.1, 0.0, -0.1, 0.0, 0.1, 0.0;
  Options options;
  options.preset = Preset::Paper;
  const PosteriorEstimate expected = estimateOf(problem, options);
  ASSERT_GT(expected.samples.rows(), 0);
  EXPECT_EQ(run("paper", problem).draws, expected.samples);
}

TEST(CoverageMethods, ExactIsThePresetThatItsNameStates)
{
  CoverageCase problem = rightPosterior(2, 0).problem;
  problem.source = Eigen::Matrix3Xd::Random(3, 200);
  problem.target = Eigen::Matrix3Xd::Random(3, 500);
  Options options;
  options.preset = Preset::Exact;
  options.exact.residual.residual = Residual::DistributionToDistribution;
  options.exact.steps = ExactSteps::SteinNewton;
  options.exact.scale = {300.0, 0.05};
  options.exact.max_source_points = 90;
  const PosteriorEstimate expected = estimateOf(problem, options);
  ASSERT_GT(expected.samples.rows(), 0);
  const MethodResult result = timedResult(
      exactMethod("exact:distribution-to-distribution:stein-newton:0.05:300:90"),
      problem);
  EXPECT_EQ(result.draws, expected.samples);
  EXPECT_EQ(result.notes, std::string("flag:") + toString(expected.summary.status));
}

TEST(CoverageMethods, PriorIsAsLikelyAsItSays)
{
  // Its z are those of the prior's own coordinates, to first order.
  CoverageCase problem = rightPosterior(1, 0).problem;
  Vector6d deviation;
  deviation << 0.01, -0.02, 0.03, 1e-4, 2e-4, -1e-4;
  problem.prior_mean = Vector6d::Zero();
  const Eigen::Vector3d centroid = problem.source.rowwise().mean();
  problem.truth.linear() = rotationOf(deviation);
  problem.truth.translation() =
      centroid + deviation.head<3>() - problem.truth.linear() * centroid;
  const CoverageScore score = coverageScoreOf(problem, run("prior", problem));
  ASSERT_TRUE(score.is_valid);
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(score.z[k], deviation[k] / problem.prior_sd[k], 1e-4) << k;
}
