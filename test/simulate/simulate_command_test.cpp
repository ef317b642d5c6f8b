/** \file
 * \brief The command pcl_bayesian_icp_simulate, run as a user would, and the committed
 * data that it made.
 */
#include "simulator/simulation.h"
#include "support/command_helpers.h"

#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

namespace fs = std::filesystem;
using bayesian_icp::simulator::sceneNames;

namespace {

const fs::path repository = BAYESIAN_ICP_REPOSITORY;
const std::string simulator = BAYESIAN_ICP_SIMULATOR;
const std::array<const char*, 7> committed_pairs = {
    "bowl", "can", "mug", "mug_hidden_handle", "table_top", "table", "corridor"};
const std::array<const char*, 4> files_of_a_pair = {
    "source.pcd", "target.pcd", "T_target_source.txt", "scene.json"};

CommandResult
simulate(const std::string& arguments)
{
  return runShell("'" + simulator + "' " + arguments);
}

Eigen::Matrix3Xf
loadPoints(const fs::path& path)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  EXPECT_EQ(pcl::io::loadPCDFile(path.string(), cloud), 0) << path;
  return cloud.getMatrixXfMap().topRows<3>();
}

/** \brief Expect the same points up to the rounding of another C library. */
void
expectSamePoints(const fs::path& expected, const fs::path& made)
{
  const Eigen::Matrix3Xf expected_points = loadPoints(expected);
  const Eigen::Matrix3Xf points = loadPoints(made);
  ASSERT_GT(points.cols(), 1000) << made;
  ASSERT_EQ(points.cols(), expected_points.cols()) << made;
  EXPECT_LE((points - expected_points).cwiseAbs().maxCoeff(), 1e-6F) << made;
}

class SimulateCommand : public FolderTest {};

} // namespace

TEST_F(SimulateCommand, HelpsAndListsScenes)
{
  const CommandResult help = simulate("--help");
  EXPECT_EQ(help.exit_code, 0);
  const std::string all_errors = " --noise-correlation 0.5 --incidence-noise 1";
  ASSERT_EQ(simulate("--scene can -o " + folder_.string() + all_errors).exit_code, 0);
  ASSERT_EQ(simulate("--scene room -o " + (folder_ / "room").string()).exit_code, 0);
  for (const fs::path& record : {folder_ / "scene.json", folder_ / "room/scene.json"}) {
    const auto json = nlohmann::json::parse(contentOf(record));
    for (const auto& option : json["options"].items())
      EXPECT_NE(help.output.find("--" + option.key() + " "), std::string::npos)
          << option.key();
  }
  const CommandResult list = simulate("-list-scenes");
  EXPECT_EQ(list.exit_code, 0);
  for (const std::string& name : sceneNames())
    EXPECT_NE(list.output.find(name + ": "), std::string::npos) << name;
}

TEST_F(SimulateCommand, TakesOneOrTwoDashesAndNegativeNumbers)
{
  const std::string out = folder_.string();
  ASSERT_EQ(simulate("-scene can -offset -0.1,-.2,3e-1,0,0,0 -seed=7 -output " + out)
                .exit_code,
            0);
  const std::string once = contentOf(folder_ / "source.pcd");
  EXPECT_EQ(contentOf(folder_ / "T_target_source.txt"),
            "1 0 0 -0.10000000000000001\n0 1 0 -0.20000000000000001\n"
            "0 0 1 0.29999999999999999\n0 0 0 1\n");
  ASSERT_EQ(
      simulate("--scene can --offset=-0.1,-0.2,0.3,0,0,0 --seed 7 -o " + out).exit_code,
      0);
  EXPECT_EQ(once, contentOf(folder_ / "source.pcd"));
}

TEST_F(SimulateCommand, RefusesBadArgumentsAndWritesNothing)
{
  const std::string out = " -o " + (folder_ / "out").string();
  for (const std::string bad : {"",
                                "--scene can --output",
                                "--scene moon",
                                "--scene can extra",
                                "--scene can --sead 3",
                                "--scene can --out x",
                                "--scene can --seed -1",
                                "--scene can --seed 1.5",
                                "--scene can --width many",
                                "--scene can --width 0",
                                "--scene can --noise nan",
                                "--scene can --outliers 1.1",
                                "--scene can --noise-correlation 2",
                                "--scene can --incidence-noise no",
                                "--scene can --offset 1,2,3",
                                "--scene can --offset 1,2,3,4,5,6,7",
                                "--scene can --offset 1,2,3,4,5,",
                                "--scene can --target-eye 0,0,0",
                                "--scene can --target-look-at 0,-0.62,0.32",
                                "--scene can --target-look-at 0,-5,0",
                                "--scene can --sensor sonar",
                                "--scene street --sensor lidar12",
                                "--scene street --sweep-motion 2",
                                "--scene can --sweep-motion 0.5",
                                "--scene can --frame world",
                                "--scene can --quantisation fine",
                                "--scene room --quantisation kinect",
                                "--scene can --scene mug"}) {
    const CommandResult result = simulate(bad + out);
    EXPECT_EQ(result.exit_code, 2) << bad << '\n' << result.output;
    EXPECT_EQ(result.output.rfind("pcl_bayesian_icp_simulate: ", 0), 0U) << bad;
  }
  EXPECT_EQ(simulate("--scene can").exit_code, 2) << "no output folder";
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(SimulateCommand, WritesTheSameBytesForAnyNumberOfThreads)
{
  const std::string arguments =
      " --scene mug --outliers 0.05 --jitter 1 --noise-correlation 0.7 -o ";
  for (const std::string threads : {"1", "3"})
    ASSERT_EQ(runShell("OMP_NUM_THREADS=" + threads + " '" + simulator + "'" +
                       arguments + (folder_ / threads).string())
                  .exit_code,
              0);
  for (const char* file : files_of_a_pair)
    EXPECT_EQ(contentOf(folder_ / "1" / file), contentOf(folder_ / "3" / file)) << file;
}

TEST_F(SimulateCommand, RecordsACommandLineThatMakesThePairAgain)
{
  const std::string first = (folder_ / "first").string();
  const std::string again = (folder_ / "again").string();
  for (const std::string arguments :
       {"--scene stairs --width 100 --height 80 --quantisation 0.002 --lateral-noise "
        "0.5 "
        "--outliers 0.02 --outlier-spread 0.3 --jitter 0.3 --fov 50 --min-range 0.5 "
        "--source-eye -1.25,0.07,1.3 --source-look-at 0,0,0.4 --seed "
        "18446744073709551615",
        "--scene room --range-noise 0.01 --noise 2 --rings 8 --min-elevation -20 "
        "--max-elevation 5 --azimuth-step 1.5 --max-range 4 --same-view --frame object "
        "--offset 0.1,0,-0.05,0,0.02,-0.3 --dropout-from 70",
        "--scene street --sensor lidar64 --azimuth-step 2 --sweep-motion 1 "
        "--ring-offset 0.02 --sensor-seed 7 --incidence-noise 0",
        "--scene carton --noise-correlation 0.5 --noise-correlation-pixels 4 "
        "--incidence-noise 1.5"}) {
    ASSERT_EQ(simulate(arguments + " -o " + first).exit_code, 0);
    const auto record = nlohmann::json::parse(contentOf(folder_ / "first/scene.json"));
    const std::string line = record["command_line"];
    ASSERT_EQ(line.rfind("pcl_bayesian_icp_simulate ", 0), 0U);
    ASSERT_EQ(simulate(line.substr(line.find(' ')) + " -o " + again).exit_code, 0);
    for (const char* file : files_of_a_pair)
      EXPECT_EQ(contentOf(folder_ / "first" / file),
                contentOf(folder_ / "again" / file));
  }
}

TEST_F(SimulateCommand, MakesTheCommittedDataAgain)
{
  const CommandResult made =
      runShell("'" + (repository / "scripts/make-data").string() + "' '" + simulator +
               "' '" + folder_.string() + "'");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  const std::string readme = contentOf(repository / "data/README.md");
  for (const std::string name : committed_pairs) {
    const fs::path committed = repository / "data" / name;
    const fs::path again = folder_ / "data" / name;
    expectSamePoints(committed / "source.pcd", again / "source.pcd");
    expectSamePoints(committed / "target.pcd", again / "target.pcd");
    EXPECT_EQ(contentOf(committed / "T_target_source.txt"),
              contentOf(again / "T_target_source.txt"));
    const auto points =
        nlohmann::json::parse(contentOf(again / "scene.json"))["points"];
    EXPECT_NE(readme.find(points["source"].dump() + " / " + points["target"].dump()),
              std::string::npos)
        << "data/README.md states other point counts for " << name;
  }
}
