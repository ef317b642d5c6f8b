// Real pairs as cases of the coverage study.
#include "coverage/coverage_methods.h"
#include "coverage/coverage_real.h"
#include "evaluation/paper_pairs.h"
#include "io/errors.h"
#include "support/command_helpers.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <boost/algorithm/string/replace.hpp>

#include <cmath>
#include <filesystem>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;
namespace fs = std::filesystem;

namespace {

class RealPairsTest : public FolderTest {};

/** A pair of 40 points with the source a half turn about z from the target. */
void
writePair(const fs::path& folder)
{
  fs::create_directories(folder / "pair");
  Random random(1, 0);
  Eigen::Matrix3Xd points(3, 40);
  for (auto point : points.colwise())
    point << 3.0 + random.normal(), random.normal(), 0.5;
  writeCloud(folder / "pair/source.pcd", points);
  writeCloud(folder / "pair/target.pcd", points);
  writeFile((folder / "pair/truth.txt").string(),
            "-1 0 0 0.5\n0 -1 0 0\n0 0 1 0\n0 0 0 1\n");
  writeFile((folder / "manifest.json").string(),
            R"([{"name": "pair",
            "files": {"source": "pair/source.pcd", "target": "pair/target.pcd",
                      "ground_truth": "pair/truth.txt"},
            "ground_truth_accuracy": {"translation_m": 0.3, "rotation_deg": 9.0},
            "suggested_prior_sigma": {"translation_m": 0.2, "rotation_rad": 0.1}}])");
}

} // namespace

TEST_F(RealPairsTest, RealPosesAreDrawnFromThePrior)
{
  writePair(folder_);
  const RealPairs pairs(folder_.string());
  ASSERT_EQ(pairs.names(), std::vector<std::string>{"pair"});
  constexpr int num_cases = 400;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= num_cases; ++seed) {
    const CoverageCase made = pairs.makeCase("pair", seed);
    sum += priorOf(made)
               .deviation(poseOf(made.truth.matrix()))
               .cwiseQuotient(made.prior_sd)
               .squaredNorm();
    // The file's points, turned by half a turn and shifted.
    ASSERT_EQ(made.source.cols(), 40);
    const Eigen::Vector3d moved =
        made.truth * Eigen::Vector3d(made.source.rowwise().mean());
    const Eigen::Vector3d target = made.target.rowwise().mean();
    EXPECT_LT((moved - Eigen::Vector3d(0.5 - target.x(), -target.y(), 0.5)).norm(),
              1e-6);
  }
  // Chi-square with 6 degrees of freedom: mean 6, variance 12; 4 standard errors.
  EXPECT_NEAR(sum / num_cases, 6.0, 4.0 * std::sqrt(12.0 / num_cases));
  const CoverageCase made = pairs.makeCase("pair", 1);
  EXPECT_NEAR(made.truth_sd.translation, 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(
      made.truth_sd.rotation, 9.0 * std::acos(-1.0) / 180.0 / std::sqrt(3.0), 1e-12);
  EXPECT_EQ(made.source, pairs.makeCase("pair", 1).source);
}

TEST_F(RealPairsTest, BadFoldersOfPairsAreNamed)
{
  EXPECT_THROW(RealPairs((folder_ / "none").string()), io::FileError);
  const auto refuseManifest = [&](const std::string& manifest) {
    writeFile((folder_ / "manifest.json").string(), manifest);
    EXPECT_THROW(RealPairs(folder_.string()), io::FileError) << manifest;
  };
  refuseManifest(R"([{"name": "pair"}])");
  writePair(folder_);
  const std::string good = contentOf(folder_ / "manifest.json");
  const std::string pair = good.substr(1, good.size() - 2);
  refuseManifest('[' + pair + ',' + pair + ']');
  refuseManifest(
      boost::replace_all_copy(good, "\"name\": \"pair\"", "\"name\": \"a/b\""));
  refuseManifest(boost::replace_all_copy(good, "0.2", "0"));
  refuseManifest(boost::replace_all_copy(good, "0.2", "-0.2"));
  writePair(folder_);
  writeFile((folder_ / "pair/truth.txt").string(), "1 0 0 0\n0 1 0 0\n");
  EXPECT_THROW(RealPairs(folder_.string()).makeCase("pair", 1), io::FileError);
}
