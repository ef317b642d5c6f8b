#include "pose_graph/graph_command.h"

#include "io/command_line.h"
#include "io/folders.h"
#include "register/settings_options.h"

#include <algorithm>
#include <sstream>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

po::options_description
describeOptionsOfGraph(GraphCommand& command)
{
  po::options_description group("General");
  // clang-format off
  group.add_options()
    ("help,h", "Show this text.")
    ("version", "Show the version.")
    ("output,o", io::fileName("FILE", command.output_file),
     "File for the graph in g2o's format. (required)")
    ("loop", po::value<std::vector<std::string>>()->value_name("I,J"),
     "Also register scan J to scan I, counted from 0. May be given several times. "
     "Without it, the graph is a chain.")
    ("weak-edges", io::flag(command.request.has_weak_edges),
     "Make an edge of the prior where a scan cannot be registered to the one before. "
     "Without it, that edge is missing.")
    ("quiet", io::flag(command.is_quiet), "Print problems only.");
  // clang-format on
  po::options_description all;
  all.add(group);
  describeSettings(Settings(), all);
  return all;
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

std::string
helpText(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_pose_graph FOLDER -o FILE.g2o [options]
       pcl_bayesian_icp_pose_graph SCAN SCAN ... -o FILE.g2o [options]

Registers each scan to the one before it and writes a pose graph in g2o's
format. The scans of a folder are its .pcd files, sorted by name. Vertex k is
the pose of scan k in the frame of scan 0. An edge has the posterior mean of a
registration and its information. --guess and the prior describe the motion
from one scan to the next: state your odometry there, and do not add it to the
graph again. Edges of --loop have the information of the clouds alone, because
their prior comes from the chain. A posterior that is neither ok nor doubtful
makes no edge; missing and doubtful edges are reported. For more, see
docs/pose_graph_and_filter.md.
)" << options
       << R"(
Exit codes:
  0    all registrations are ok
  1    some are not; the graph has been written
  2    wrong usage
  3    a file cannot be used or written
  130  interrupted (Ctrl-C or SIGTERM); nothing has been written

Example:
  pcl_bayesian_icp_pose_graph scans -o graph.g2o --loop 0,3 \
      --guess 0.5,0,0,0,0,0 --prior-variance 0.01,0.01,0.0004,1e-4,1e-4,1e-2
)";
  return help.str();
}

} // namespace

std::optional<GraphCommand>
parseGraphCommand(int argc, const char* const* argv)
{
  GraphCommand command;
  const po::options_description options = describeOptionsOfGraph(command);
  const po::variables_map given = io::splitCommandLine(argc, argv, options, "scan");
  if (io::printHelpOrVersion(given,
                             "pcl_bayesian_icp_pose_graph " BAYESIAN_ICP_VERSION,
                             [&options] { return helpText(options); }))
    return std::nullopt;
  GraphRequest& request = command.request;
  request.scans = io::scansOf(io::optionTexts(given, "scan"));
  io::takeOptions(given, options);
  if (command.output_file.empty())
    throw io::UsageError("--output is needed");
  for (const std::string& text : io::optionTexts(given, "loop"))
    request.loops.push_back(loopOf(text, request.scans.size()));
  request.settings = settingsFrom(given, Settings(), command.note);
  return command;
}

} // namespace bayesian_icp::app
