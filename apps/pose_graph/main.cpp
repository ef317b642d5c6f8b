/** \file
 * \brief pcl_bayesian_icp_pose_graph: scans in, a pose graph and its most likely poses
 * out.
 */
#include "graph/sensor_plane.h"
#include "graph/trajectory_files.h"
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/errors.h"
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "pose_graph/graph_report.h"
#include "register/choices.h"
#include "register/cloud_notes.h"
#include "register/settings_options.h"
#include "report/section.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>

namespace bayesian_icp::app {
namespace {

namespace po = boost::program_options;

/** What the user asks for. */
struct GraphCommand {
  GraphRequest request;
  /** At least one of them is not empty. */
  std::string output_file;
  std::string optimized_folder;
  RobustLoss loss = RobustLoss::None;
  bool is_quiet = false;
  /** As a shell takes it. */
  std::string command;
};

constexpr int max_span = 1000;
/** [m] */
constexpr double max_radius = 1e6;

po::options_description
describeOptions(GraphCommand& command)
{
  po::options_description group = io::generalOptions();
  // clang-format off
  group.add_options()
    ("output,o", io::fileName("FILE", command.output_file),
     "File for the graph in g2o's format. (this or --optimize is required)")
    ("quiet", io::flag(command.is_quiet), "Print problems only.");
  po::options_description edges("Edges");
  edges.add_options()
    ("span", io::number("N", command.request.span),
     "Also register each scan to those up to N before it. (default 1)")
    ("loop", po::value<std::vector<std::string>>()->value_name("I,J"),
     "Also register scan J to scan I, counted from 0; not to its neighbour. May be given "
     "several times.")
    ("loops", io::number("M", command.request.loop_radius),
     "Also register each scan to the nearest earlier one within M metres according to "
     "the chain, if the sensor was more than 2 M away in between. Such an edge must "
     "have status ok and agree with the chain (0.1 %).")
    ("weak-edges", io::flag(command.request.has_weak_edges),
     "Use the prior as the edge where a scan cannot be registered to the one before. "
     "Without it, that edge is missing.");
  po::options_description optimization("Optimization");
  optimization.add_options()
    ("optimize", io::fileName("FOLDER", command.optimized_folder),
     "Find the most likely poses of the graph, and write them, their covariances, a "
     "report and the graph to this folder.")
    ("robust-loss", io::taken("LOSS", [&command](const std::string& name) {
       if (!readChoice(name, command.loss))
         io::refuseValue(name, namesOfChoices(command.loss));
     }),
     "Weight of edges outside their 95 % regions: none, as their covariances state; "
     "huber, they pull no harder than at the border; cauchy, they pull less and less. "
     "(default none)");
  // clang-format on
  po::options_description all;
  all.add(group).add(edges).add(optimization);
  describeSettings(all);
  return all;
}

std::pair<int, int>
loopOf(const std::string& text, std::size_t num_scans)
{
  std::array<int, 2> loop = {-1, -1};
  const auto& [target, source] = loop;
  const bool is_good = io::readNumbers(text, loop) && target >= 0 && source >= 0 &&
                       target != source &&
                       static_cast<std::size_t>(std::max(target, source)) < num_scans;
  if (!is_good)
    throw io::UsageError("--loop: " + io::inQuotes(text) +
                         " is not two different scans I,J from 0 to " +
                         io::textOf(num_scans - 1));
  if (std::abs(target - source) == 1)
    throw io::UsageError("--loop: " + io::inQuotes(text) +
                         " are neighbours, which have an edge of the chain already");
  return {target, source};
}

void
check(const po::variables_map& given, const GraphCommand& command)
{
  const GraphRequest& request = command.request;
  if (command.output_file.empty() && command.optimized_folder.empty())
    throw io::UsageError("--output or --optimize is needed");
  std::error_code unknown;
  if (std::filesystem::is_directory(command.output_file, unknown))
    throw io::UsageError("--output: " + io::inQuotes(command.output_file) +
                         " is a folder; --optimize takes one");
  for (const std::string& scan : request.scans)
    if (io::isSameFile(scan, command.output_file))
      throw io::UsageError("--output: " + io::inQuotes(command.output_file) +
                           " is one of the scans");
  if (given.count("robust-loss") > 0 && command.optimized_folder.empty())
    throw io::UsageError("--robust-loss needs --optimize");
  if (request.span < 1 || request.span > max_span)
    throw io::UsageError("--span is " + io::textOf(request.span) +
                         ", but must be from 1 to " + io::textOf(max_span));
  if (given.count("loops") > 0 &&
      !(request.loop_radius > 0.0 && request.loop_radius <= max_radius))
    throw io::UsageError("--loops is " + io::textOf(request.loop_radius) +
                         ", but must be above 0 and at most " + io::textOf(max_radius) +
                         " m");
  if (request.settings.are_lengths_scaled &&
      (request.span > 1 || !request.loops.empty() || request.loop_radius > 0.0))
    throw io::UsageError("--span, --loop and --loops need settings in metres, not in "
                         "units of a cloud's size");
}

const io::ToolText tool_text = {
    "pcl_bayesian_icp_pose_graph " BAYESIAN_ICP_VERSION,
    R"(Usage: pcl_bayesian_icp_pose_graph FOLDER -o FILE.g2o [options]
       pcl_bayesian_icp_pose_graph FOLDER --optimize FOLDER [options]
       pcl_bayesian_icp_pose_graph SCAN SCAN ... -o FILE.g2o [options]

Registers each scan to the one before it and writes a pose graph in g2o's
format. The scans of a folder are its .pcd files, sorted by name. Vertex k is
the pose of scan k in the frame of scan 0. An edge has the posterior mean of a
registration and its information. --guess and the prior describe the motion
from one scan to the next: state your odometry there, and do not add it to the
graph again. Edges of --span, --loop and --loops have the information of the
clouds alone; the mean of their prior is the pose according to the chain. A
posterior that is neither ok nor doubtful makes no edge. A doubtful one makes
no edge of --span or --loops. Missing and doubtful edges are reported. A loop
that you name stays in the graph even if it contradicts the chain.

--optimize FOLDER finds the poses that fit all edges best. FOLDER gets
  trajectory_tum.txt         scan number, position (m) and quaternion of each
                             scan in the frame of scan 0
  trajectory_covariance.txt  the 6x6 covariances, in ROS's convention (m, rad)
  graph.g2o                  the graph, with these poses
  report.html                the trajectory, the closure of cycles, and edges that
                             contradict the others (needs gnuplot)

For more, see docs/pose_graph_and_filter.md.
)",
    R"(
Exit codes:
  0    all registrations are ok, except for those of --loops
  1    some are not, a loop that you named or an optimized edge contradicts the
       others, none of an edge's cycles closes, or the poses cannot be
       optimized; the graph has been written
  2    wrong usage
  3    a file cannot be used or written
  130  interrupted (Ctrl-C or SIGTERM); nothing has been written

Example:
  pcl_bayesian_icp_pose_graph scans -o graph.g2o --loop 0,3 \
      --guess 0.5,0,0,0,0,0 --prior-variance 0.01,0.01,0.0004,1e-4,1e-4,1e-2
  pcl_bayesian_icp_pose_graph scans --span 3 --loops 2 --optimize result
)"};

/** As io::readCommandLine(), and looks into the folder that it names. */
GraphCommand
parseCommandLine(int argc, const char* const* argv)
{
  GraphCommand command;
  const po::options_description options = describeOptions(command);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, "scan", tool_text);
  GraphRequest& request = command.request;
  request.scans = io::scansOf(io::optionTexts(given, "scan"));
  io::takeOptions(given, options);
  for (const std::string& text : io::optionTexts(given, "loop"))
    request.loops.push_back(loopOf(text, request.scans.size()));
  request.settings = settingsFrom(given);
  check(given, command);
  command.command = io::commandOf(argc, argv);
  return command;
}

/** The most likely poses, if they can be found.
 * \param[in] edges that \p graph has taken */
std::optional<OptimizedPoses>
optimized(const ScanGraph& graph, const std::vector<GraphEdge>& edges, RobustLoss loss)
{
  std::vector<Eigen::Matrix4d> poses;
  for (const GaussianPose& pose : graph.chain)
    poses.push_back(matrixOf(pose.mean));
  std::string complaint;
  try {
    OptimizedPoses found = optimizedPoses(poses, edges, loss);
    if (found.complaint.empty())
      return found;
    complaint = found.complaint;
  }
  catch (const std::invalid_argument& error) {
    complaint = error.what();
  }
  io::tell("the poses cannot be optimized: " + complaint +
           "; the graph is written with the poses of the chain");
  return std::nullopt;
}

/** \return whether there are none */
bool
tellDisagreements(const std::vector<GraphEdge>& edges,
                  const std::vector<ClosedCycle>& cycles,
                  const OptimizedPoses& optimum)
{
  const std::vector<Disagreement> all = disagreementsOf(cycles, optimum);
  for (const Disagreement& found : all)
    io::tell(
        "edge " + nameOf(edges[found.edge]) + " contradicts the others: " +
        (isContradiction(found.squared_error)
             ? "squared error " + io::fixedTextOf(found.squared_error, 1) +
                   " for 6 degrees of freedom"
             : "none of its " + io::textOf(found.num_open_cycles) + " cycles closes"));
  return all.empty();
}

/** Files of --optimize but for the graph; without an optimum there are none. */
void
addOptimum(const GraphCommand& command,
           const ScanGraph& graph,
           const std::vector<ClosedCycle>& cycles,
           const std::optional<OptimizedPoses>& optimum,
           io::OutputFolder& folder)
{
  if (!optimum) {
    for (const char* name :
         {"trajectory_tum.txt", "trajectory_covariance.txt", "report.html"})
      folder.leaveOut(name);
    return;
  }
  std::vector<std::int64_t> numbers; // in place of times
  for (std::size_t k = 0; k < graph.chain.size(); ++k)
    numbers.push_back(1'000'000'000 * static_cast<std::int64_t>(k));
  folder.add("trajectory_tum.txt", tumText(numbers, optimum->poses));
  folder.add("trajectory_covariance.txt", tumCovarianceText(numbers, optimum->poses));
  addReport([&] { return graphReportHtml(graph, *optimum, cycles, command.command); },
            folder);
}

/** None of a scan that cannot be read: the edge to it tells. */
std::optional<Eigen::Vector3d>
planeNormalOfScan(const std::string& file)
{
  try {
    return planeNormalOf(io::readFinitePoints(file).cast<double>());
  }
  catch (const io::FileError&) {
    return std::nullopt;
  }
}

int
makeGraph(const GraphCommand& command)
{
  if (!command.request.settings.note.empty() && !command.is_quiet)
    io::tell("note: " + command.request.settings.note);
  io::silencePcl();
  const std::filesystem::path file(command.output_file);
  std::optional<io::OutputFolder> folder_of_file, optimized_folder;
  if (!file.empty())
    folder_of_file.emplace(io::folderOf(file));
  if (!command.optimized_folder.empty())
    optimized_folder.emplace(command.optimized_folder);
  if (folder_of_file)
    folder_of_file->fileOf(file.filename().string());
  bool is_good = true;
  if (!command.is_quiet)
    tellNotesOfFirst(command.request.scans.front(), command.request.settings);
  GraphRequest request = command.request;
  request.plane_normal = planeNormalOfScan(request.scans.front());
  if (request.plane_normal && !command.is_quiet)
    io::tell(plane_note);
  io::catchInterrupt();
  const ScanGraph graph =
      registerScans(request, [&](bool is_ok, const std::string& line) {
        is_good = is_good && is_ok;
        if (!is_ok || !command.is_quiet)
          io::tell(line);
      });
  if (io::wasInterrupted()) {
    io::tell("interrupted; nothing is written");
    return io::Interrupted;
  }
  io::tell(unmeasuredText(graph.numUnmeasured(), graph.chain.size() - 1));
  std::vector<GraphEdge> edges;
  for (const ScanEdge& taken : graph.taken())
    edges.push_back(taken.edge);
  std::optional<OptimizedPoses> optimum;
  if (optimized_folder) {
    optimum = optimized(graph, edges, command.loss);
    std::vector<ClosedCycle> cycles;
    if (optimum)
      cycles = closedCycles(edges, edges.size() + 1);
    is_good = optimum && tellDisagreements(edges, cycles, *optimum) && is_good;
    addOptimum(command, graph, cycles, optimum, *optimized_folder);
  }
  const std::string text = g2oText(optimum ? optimum->poses : graph.chain, edges);
  if (folder_of_file)
    folder_of_file->add(file.filename().string(), text);
  if (optimized_folder)
    optimized_folder->add("graph.g2o", text);
  if (folder_of_file)
    folder_of_file->commit();
  if (optimized_folder)
    optimized_folder->commit();
  return is_good ? io::Good : io::NotGood;
}

} // namespace
} // namespace bayesian_icp::app

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp_pose_graph", [&] {
    return app::makeGraph(app::parseCommandLine(argc, argv));
  });
}
