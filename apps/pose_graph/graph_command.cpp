#include "pose_graph/graph_command.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "register/option_descriptions.h"
#include "register/settings_options.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <system_error>

namespace bayesian_icp::app {

namespace po = boost::program_options;
namespace fs = std::filesystem;

namespace {

po::options_description
describeOptionsOfGraph()
{
  po::options_description group("General");
  group.add_options()("help,h", "show this text");
  group.add_options()("version", "show the version");
  group.add_options()("output,o",
                      po::value<std::string>()->value_name("FILE"),
                      "the graph in g2o's format (required)");
  group.add_options()("loop",
                      po::value<std::vector<std::string>>()->value_name("I,J"),
                      "also register scan J to scan I, counted from 0; may be given "
                      "several times");
  group.add_options()("weak-edges",
                      "where a scan cannot be registered to the one before, make an "
                      "edge of the prior");
  group.add_options()("quiet", "print only what is wrong");
  po::options_description all;
  all.add(group);
  describeSettings(Settings(), all);
  return all;
}

/** The .pcd files of a folder by name, or the files themselves. */
std::vector<std::string>
scansOf(const std::vector<std::string>& arguments)
{
  std::error_code error;
  if (arguments.size() != 1 || !fs::is_directory(arguments[0], error))
    return arguments;
  std::vector<std::string> scans;
  for (const auto& entry : fs::directory_iterator(arguments[0], error))
    if (entry.path().extension() == ".pcd")
      scans.push_back(entry.path().string());
  if (error)
    throw io::FileError(arguments[0], error.message());
  std::sort(scans.begin(), scans.end());
  if (scans.size() < 2)
    throw io::FileError(arguments[0], "has fewer than two .pcd files");
  return scans;
}

std::pair<int, int>
loopOf(const std::string& text, std::size_t num_scans)
{
  const auto items = io::splitAt(',', text);
  int target = -1, source = -1;
  const bool is_good = items.size() == 2 && io::readNumber(items[0], target) &&
                       io::readNumber(items[1], source) && target >= 0 && source >= 0 &&
                       target != source &&
                       static_cast<std::size_t>(std::max(target, source)) < num_scans;
  if (!is_good)
    throw io::UsageError("--loop: " + io::quoted(text) +
                         " is not two different scans I,J from 0 to " +
                         io::textOf(num_scans - 1));
  return {target, source};
}

} // namespace

GraphCommand
parseGraphCommand(int argc, const char* const* argv)
{
  const po::variables_map given =
      io::splitCommandLine(argc, argv, describeOptionsOfGraph(), "scan");
  GraphCommand command;
  if (given.count("help") > 0 || given.count("version") > 0) {
    command.kind = given.count("help") > 0 ? GraphCommand::Kind::ShowHelp
                                           : GraphCommand::Kind::ShowVersion;
    return command;
  }
  GraphRequest& request = command.request;
  request.scans = scansOf(io::optionTexts(given, "scan"));
  if (request.scans.size() < 2)
    throw io::UsageError("a folder or at least two scans are needed");
  command.output_file = io::optionText(given, "output");
  if (command.output_file.empty())
    throw io::UsageError("--output is needed");
  for (const std::string& text : io::optionTexts(given, "loop"))
    request.loops.push_back(loopOf(text, request.scans.size()));
  request.has_weak_edges = given.count("weak-edges") > 0;
  request.settings = settingsFrom(given, Settings(), command.note);
  command.is_quiet = given.count("quiet") > 0;
  return command;
}

std::string
graphHelpText()
{
  std::ostringstream help;
  help << "Usage: pcl_bayesian_icp_pose_graph FOLDER -o FILE.g2o [options]\n"
          "       pcl_bayesian_icp_pose_graph SCAN SCAN ... -o FILE.g2o [options]\n\n"
          "Registers each scan to the one before it (of a folder: its .pcd files, by "
          "name) and\n"
          "writes a pose graph for g2o and whatever reads its format. Vertex k is the "
          "pose of\n"
          "scan k in the frame of scan 0; an edge has the posterior mean of a "
          "registration and\n"
          "its information. --guess and the prior are about the motion from one scan "
          "to the\n"
          "next; state your odometry there, and do not add it to the graph again. "
          "Edges of\n"
          "--loop have the information of the clouds alone: their prior comes from the "
          "chain.\n"
          "A posterior that is neither ok nor doubtful makes no edge; what is missing "
          "or\n"
          "doubtful is told. docs/pose_graph_and_filter.md says more.\n"
       << describeOptionsOfGraph()
       << "\nExit codes:\n"
          "  0    all registrations are ok\n"
          "  1    some are not; the graph has been written\n"
          "  2    wrong usage\n"
          "  3    a file cannot be used or written\n"
          "  130  interrupted (Ctrl-C or SIGTERM); nothing has been written\n"
          "\nExample:\n"
          "  pcl_bayesian_icp_pose_graph scans -o graph.g2o --loop 0,3 \\\n"
          "      --guess 0.5,0,0,0,0,0 --prior-variance "
          "0.01,0.01,0.0004,1e-4,1e-4,1e-2\n";
  return help.str();
}

} // namespace bayesian_icp::app
