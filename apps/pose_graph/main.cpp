/** \file
 * \brief pcl_bayesian_icp_pose_graph: scans in, a pose graph and its most likely poses
 * out.
 */
#include "graph/trajectory_files.h"
#include "io/cloud_file.h"
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "pose_graph/graph_command.h"
#include "pose_graph/graph_report.h"
#include "register/cloud_notes.h"
#include "report/section.h"

#include <filesystem>
#include <optional>
#include <stdexcept>

namespace bayesian_icp::app {
namespace {

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
  addReport([&] { return graphReportHtml(command, graph, *optimum, cycles); }, folder);
}

int
makeGraph(const GraphCommand& command)
{
  if (!command.note.empty() && !command.is_quiet)
    io::tell("note: " + command.note);
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
  io::catchInterrupt();
  const ScanGraph graph =
      registerScans(command.request, [&](bool is_ok, const std::string& line) {
        is_good = is_good && is_ok;
        if (!is_ok || !command.is_quiet)
          io::tell(line);
      });
  if (io::wasInterrupted()) {
    io::tell("interrupted; nothing is written");
    return io::Interrupted;
  }
  io::tell(unmeasuredText(graph.numUnmeasured(), graph.chain.size() - 1));
  const std::vector<GraphEdge> edges = edgesOf(graph.taken());
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
    const auto command = app::parseGraphCommand(argc, argv);
    return command ? app::makeGraph(*command) : io::Good;
  });
}
