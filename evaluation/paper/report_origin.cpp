#include "paper/report_origin.h"

#include <pcl/pcl_config.h>

#include <boost/version.hpp>

#include <io/numbers.h>
#include <plot/child_program.h>

#include <fstream>
#include <thread>

namespace bayesian_icp::evaluate {

namespace {

std::string
commandOf(const PaperOptions& options)
{
  std::string command = "pcl_bayesian_icp_evaluate paper --data " + options.data_folder;
  std::string pairs;
  for (const std::string& name : options.pairs)
    pairs += (pairs.empty() ? "" : ",") + name;
  if (!pairs.empty())
    command += " --pairs " + pairs;
  return command + " --baseline-runs " + std::to_string(options.num_baseline_runs) +
         " --start-translation " + io::textOf(options.start_translation) +
         " --start-rotation " + io::textOf(options.start_rotation) + " --repeats " +
         std::to_string(options.num_repeats) + " --points " +
         std::to_string(options.num_points) + " --seed " + io::textOf(options.seed) +
         " --threads " + std::to_string(options.num_threads) + " --output " +
         options.output_folder + (options.is_quick ? " --quick" : "");
}

std::string
gnuplotVersion()
{
  const std::string text = plot::runChildProgram({"gnuplot", "--version"}, "").output;
  return text.substr(0, text.find('\n'));
}

std::string
processorName()
{
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.compare(0, 10, "model name") == 0)
      return line.substr(line.find(':') + 2);
  return "unknown processor";
}

} // namespace

ReportSection
originSection(const PaperOptions& options)
{
  ReportSection section;
  section.title = "How to repeat it";
  section.blocks.emplace_back(ReportText{
      "Results other than times depend on nothing but this command, the data and the "
      "versions below; not on the number of threads."});
  section.blocks.emplace_back(ReportCode{commandOf(options)});
  ReportTable table;
  table.caption = "Versions and machine.";
  table.header = {"what", "version"};
  table.rows = {{"pcl_bayesian_icp", BAYESIAN_ICP_VERSION},
                {"compiler", "g++ or compatible " __VERSION__},
                {"PCL", PCL_VERSION_PRETTY},
                {"Eigen",
                 std::to_string(EIGEN_WORLD_VERSION) + '.' +
                     std::to_string(EIGEN_MAJOR_VERSION) + '.' +
                     std::to_string(EIGEN_MINOR_VERSION)},
                {"Boost", BOOST_LIB_VERSION},
                {"gnuplot", gnuplotVersion()},
                {"processor", processorName()},
                {"cores", std::to_string(std::thread::hardware_concurrency())}};
  section.blocks.emplace_back(table);
  return section;
}

} // namespace bayesian_icp::evaluate
