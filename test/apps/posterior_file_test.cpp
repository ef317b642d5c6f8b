// Reads posterior.json and samples.csv as the writer makes them, and files that are
// broken in one place each.
#include "io/errors.h"
#include "io/posterior_file.h"
#include "register/posterior_files.h"
#include "sampler/chain_set.h"
#include "summary/estimates.h"
#include "support/command_helpers.h"

#include <bayesian_icp/summary.h>

#include <nlohmann/json.hpp>

using namespace bayesian_icp;

namespace {

class PosteriorFiles : public FolderTest {
protected:
  std::string
  file(const std::string& name, const std::string& content)
  {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << content;
    return path.string();
  }

  /** What reading the content as posterior.json is refused with; empty if it is not. */
  std::string
  refusalOf(const std::string& content)
  {
    return refusal([&] { io::readPosterior(file("posterior.json", content)); });
  }

  std::string
  refusalOfSamples(const std::string& content)
  {
    return refusal([&] { io::readSamples(file("samples.csv", content)); });
  }

  template <typename Action>
  std::string
  refusal(const Action& action)
  {
    try {
      action();
    }
    catch (const io::FileError& error) {
      EXPECT_NE(std::string(error.what()).find(folder_.string()), std::string::npos)
          << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
};

PoseMatrix
someDraws(int num_draws)
{
  PoseMatrix draws(num_draws, 6);
  for (int i = 0; i < num_draws; ++i)
    for (int k = 0; k < 6; ++k)
      draws(i, k) = std::sin(1.0 + i * (k + 1.7)) / 3.0;
  return draws;
}

app::Run
runWith(const PoseMatrix& draws)
{
  app::Run run;
  run.source.file = "a \"quoted\" name.pcd";
  run.target.file = "target.ply";
  run.source.points.setZero(3, 3);
  run.target.points.setZero(3, 4);
  run.result.chains = {{draws, false}};
  ChainSet set;
  set.chains = run.result.chains;
  run.result.summary = summarize(set);
  run.result.final_matrix = matrixOf({0.1, -0.2, 0.3, 0.4, -0.5, 0.6});
  run.settings.guess = matrixOf({0.2, -0.1, 0.3, 0.4, -0.5, 0.6});
  return run;
}

std::string
posteriorText()
{
  return app::posteriorJson(runWith(someDraws(50)));
}

/** The document with one value, named by a JSON pointer, replaced. */
std::string
changed(const std::string& pointer, const nlohmann::json& value)
{
  auto document = nlohmann::json::parse(posteriorText());
  document.at(nlohmann::json::json_pointer(pointer)) = value;
  return document.dump();
}

} // namespace

TEST_F(PosteriorFiles, PosteriorReadsBackWithoutLoss)
{
  const app::Run run = runWith(someDraws(50));
  const auto read = io::readPosterior(file("p.json", app::posteriorJson(run)));
  EXPECT_EQ(read.source_file, run.source.file);
  EXPECT_EQ(read.target_file, run.target.file);
  EXPECT_EQ(read.num_source_points, 3);
  EXPECT_EQ(read.num_target_points, 4);
  EXPECT_EQ(read.num_draws, 50);
  EXPECT_EQ(read.status, toString(run.result.summary.status));
  EXPECT_EQ(read.status_message, run.result.summary.message);
  EXPECT_EQ(read.final_matrix, run.result.final_matrix);
  EXPECT_EQ(read.guess, run.settings.guess);
  EXPECT_EQ(read.mean, run.result.summary.mean);
  for (const auto convention : {CovarianceConvention::Parameters,
                                CovarianceConvention::R3xSO3,
                                CovarianceConvention::LeftSE3,
                                CovarianceConvention::RightSE3})
    EXPECT_EQ(read.covariance(convention), run.result.summary.covariance(convention));
}

TEST(PosteriorJson, HasEachNumberUnderItsName)
{
  app::Run run = runWith(someDraws(50));
  Summary& summary = run.result.summary;
  CoordinateSummary& pitch = summary.coordinates[4];
  DataReport& data = summary.data;
  data.is_available = true;
  data.directions.resize(1);
  DataDirection& direction = data.directions[0];
  const std::string coordinate = "/posterior/coordinates/4/";
  const std::pair<std::string, double&> numbers[] = {
      {coordinate + "mean", pitch.mean},
      {coordinate + "standard_deviation", pitch.standard_deviation},
      {coordinate + "quantile_2.5_percent", pitch.quantile_2_5},
      {coordinate + "median", pitch.median},
      {coordinate + "quantile_97.5_percent", pitch.quantile_97_5},
      {coordinate + "rhat", pitch.rhat},
      {coordinate + "bulk_ess", pitch.bulk_ess},
      {coordinate + "tail_ess", pitch.tail_ess},
      {coordinate + "mcse_of_mean", pitch.mcse},
      {"/data/noise_scale_m", data.noise_scale},
      {"/data/noise_scale_in_units_of_the_target", data.residual_scale},
      {"/data/effective_patches", data.effective_patches},
      {"/data/correlation_factor", data.correlation_factor},
      {"/data/active_fraction", data.active_fraction},
      {"/data/active_fraction_of_target", data.active_fraction_of_target},
      {"/data/basin_distance_in_standard_deviations", data.basin_distance},
      {"/data/other_start_cost_ratio", data.other_cost_ratio},
      {"/data/prior_probability", data.prior_probability},
      {"/data/directions/0/standard_deviation_m", direction.standard_deviation},
      {"/data/directions/0/prior_standard_deviation_m",
       direction.prior_standard_deviation},
      {"/data/directions/0/information_in_units_of_the_prior",
       direction.relative_information}};
  data.degrees_of_freedom = 100;
  double next = 1.0;
  for (const auto& [pointer, number] : numbers)
    number = next++;
  const auto document = nlohmann::json::parse(app::posteriorJson(run));
  for (const auto& [pointer, number] : numbers)
    EXPECT_EQ(document.at(nlohmann::json::json_pointer(pointer)), number) << pointer;
  EXPECT_EQ(document["data"]["degrees_of_freedom"], 100);
}

TEST_F(PosteriorFiles, UndefinedNumbersAreNan)
{
  const auto read =
      io::readPosterior(file("p.json", app::posteriorJson(runWith(someDraws(1)))));
  EXPECT_TRUE(read.mean.allFinite());
  for (const auto& covariance : read.covariances)
    EXPECT_TRUE(covariance.array().isNaN().all());
}

TEST_F(PosteriorFiles, SamplesReadBackWithoutLossAndWithoutDivergedChains)
{
  const PoseMatrix draws = someDraws(50);
  std::ostringstream text;
  app::writeSamples(
      {{draws.topRows(20), false}, {draws, true}, {draws.bottomRows(30), false}}, text);
  EXPECT_EQ(io::readSamples(file("s.csv", text.str())), draws);
  EXPECT_NE(text.str().find("\n2,0,"), std::string::npos)
      << "chains keep their numbers";
}

TEST_F(PosteriorFiles, FilesOfOtherKindsAreRefused)
{
  EXPECT_NE(refusalOf("{"), "");
  EXPECT_NE(refusalOf("[]").find("schema"), std::string::npos);
  EXPECT_NE(refusalOf("{\"a\": \xff}").find("broken JSON"), std::string::npos);
  EXPECT_NE(refusalOf(std::string(1000000, '[')).find("nested"), std::string::npos);
  EXPECT_NE(refusalOf(std::string((16 << 20) + 1, ' ')).find("too large"),
            std::string::npos);
  EXPECT_NE(refusalOf(changed("/schema", "other")).find("schema"), std::string::npos);
  EXPECT_NE(refusalOf(changed("/schema_version", 2)).find("schema_version"),
            std::string::npos);
  const auto missing = (folder_ / "missing.json").string();
  EXPECT_NE(refusal([&] { io::readPosterior(missing); }).find("no such file"),
            std::string::npos);
}

TEST_F(PosteriorFiles, BadValuesAreNamed)
{
  const struct {
    const char* pointer;
    nlohmann::json value;
    const char* path;
  } cases[] = {
      {"/source", 3, "source is '3', but must be an object"},
      {"/source/file", nullptr, "source.file"},
      {"/target/points", -1, "target.points"},
      {"/status/name", 1, "status.name"},
      {"/final_transformation/T_target_source/2/1", "1", "T_target_source[2][1]"},
      {"/final_transformation/T_target_source/2", {1, 2, 3}, "T_target_source[2]"},
      {"/posterior/mean/yaw_rad", "x", "posterior.mean.yaw_rad"},
      {"/posterior/mean", nlohmann::json::object(), "posterior.mean.x_m"},
      {"/posterior/covariances", nlohmann::json::array(), "posterior.covariances"},
      {"/posterior/covariances/1/convention", "left_se3", "covariances[1].convention"},
      {"/posterior/covariances/3/matrix/5", false, "covariances[3].matrix[5]"}};
  for (const auto& bad : cases)
    EXPECT_NE(refusalOf(changed(bad.pointer, bad.value)).find(bad.path),
              std::string::npos)
        << bad.pointer << ": " << refusalOf(changed(bad.pointer, bad.value));
}

TEST_F(PosteriorFiles, EveryTruncationIsRefused)
{
  const std::string whole = posteriorText();
  const std::size_t end = whole.find_last_of('}');
  for (std::size_t size = 1; size < end; size += 97)
    EXPECT_NE(refusalOf(whole.substr(0, size)), "") << size;
}

TEST_F(PosteriorFiles, BadSamplesAreRefusedWithTheirLine)
{
  const std::string header = std::string(io::samples_header) + '\n';
  const std::string good = "0,0,1,2,3,0.1,0.2,0.3\n";
  EXPECT_EQ(refusalOfSamples(header + good + "0,1,1,2,3,0.1,0.2,0.3"), "");
  EXPECT_NE(refusalOfSamples(header).find("no draws"), std::string::npos);
  EXPECT_NE(refusalOfSamples(good).find("first line"), std::string::npos);
  for (const char* bad : {"\n",
                          "0,1,1,2,3,0.1,0.2\n",
                          "0,1,1,2,3,0.1,0.2,0.3,0.4\n",
                          "0,-1,1,2,3,0.1,0.2,0.3\n",
                          "0,1,1,2,3,0.1,0.2,nan\n",
                          "0,1,1,2,3,0.1,0.2,inf\n",
                          "0,1,1,2,3,0.1,0.2,1e999\n",
                          "0,1,1,2,3,\"0.1\",0.2,0.3\n"})
    EXPECT_NE(refusalOfSamples(header + good + bad + good).find("line 3"),
              std::string::npos)
        << bad;
  const std::string endless(1 << 20, '1');
  EXPECT_NE(refusalOfSamples(header + endless).find("line 2"), std::string::npos);
}
