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
#include "plot/gnuplot.h"
#include "pose_graph/graph_command.h"
#include "pose_graph/graph_report.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>

namespace bayesian_icp::app {
namespace {

/** Failures have those of io::explainFailure(). */
enum ExitCode { Good = 0, NotAllOk = 1, Interrupted = io::interrupted_exit_code };

void
tell(const std::string& message)
{
  std::cerr << "pcl_bayesian_icp_pose_graph: " + message + '\n';
}

/** The most likely poses, if they are asked for and can be found. */
std::optional<OptimizedPoses>
optimized(const GraphCommand& command, const ScanGraph& graph)
{
  if (command.optimized_folder.empty())
    return std::nullopt;
  std::vector<Eigen::Matrix4d> poses;
  for (const GaussianPose& pose : graph.chain())
    poses.push_back(matrixOf(pose.mean));
  std::string complaint;
  try {
    OptimizedPoses found = optimizedPoses(poses, edgesOf(graph.taken()), command.loss);
    if (found.complaint.empty())
      return found;
    complaint = found.complaint;
  }
  catch (const std::invalid_argument& error) {
    complaint = error.what();
  }
  tell("the poses cannot be optimized: " + complaint +
       "; the graph is written with the poses of the chain");
  return std::nullopt;
}

/** \return whether there are none */
bool
tellDisagreements(const ScanGraph& graph, const OptimizedPoses& optimum)
{
  const std::vector<GraphEdge> edges = edgesOf(graph.taken());
  const std::vector<Disagreement> all = disagreementsOf(edges, optimum);
  for (const Disagreement& found : all)
    tell("edge " + nameOf(edges[found.edge]) + " contradicts the others: " +
         (isContradiction(found.squared_error)
              ? "squared error " + io::fixedTextOf(found.squared_error, 1) +
                    " for 6 degrees of freedom"
              : "none of its " + io::textOf(found.num_open_cycles) + " cycles closes"));
  return all.empty();
}

/** Files of --optimize. */
void
addOptimum(const GraphCommand& command,
           const ScanGraph& graph,
           const OptimizedPoses* optimum,
           io::OutputFolder& folder)
{
  const auto add = [&](const std::string& name, const auto& textOf) {
    if (optimum == nullptr)
      folder.leaveOut(name);
    else
      folder.add(name, [&](std::ostream& stream) { stream << textOf(); });
  };
  std::vector<double> numbers;
  for (std::size_t k = 0; k < graph.chain().size(); ++k)
    numbers.push_back(static_cast<double>(k));
  add("trajectory_tum.txt", [&] { return tumText(numbers, optimum->poses); });
  add("trajectory_covariance.txt",
      [&] { return tumCovarianceText(numbers, optimum->poses); });
  try {
    const std::string report =
        optimum != nullptr ? graphReportHtml(command, graph, *optimum) : std::string();
    add("report.html", [&] { return report; });
  }
  catch (const plot::GnuplotError& error) {
    tell(std::string(error.what()) + "; report.html is left out");
    folder.leaveOut("report.html");
  }
}

int
makeGraph(const GraphCommand& command)
{
  if (!command.note.empty() && !command.is_quiet)
    tell("note: " + command.note);
  io::silencePcl();
  std::vector<std::unique_ptr<io::OutputFolder>> folders;
  const std::filesystem::path file(command.output_file);
  if (!file.empty())
    folders.push_back(std::make_unique<io::OutputFolder>(io::folderOf(file)));
  if (!command.optimized_folder.empty())
    folders.push_back(std::make_unique<io::OutputFolder>(command.optimized_folder));
  bool is_good = true;
  ScanGraph graph(command.request, [&](bool is_ok, const std::string& line) {
    is_good = is_good && is_ok;
    if (!is_ok || !command.is_quiet)
      tell(line);
  });
  io::catchInterrupt();
  graph.registerScans();
  if (io::wasInterrupted())
    return Interrupted;
  const std::optional<OptimizedPoses> optimum = optimized(command, graph);
  if (!command.optimized_folder.empty()) {
    is_good = optimum && tellDisagreements(graph, *optimum) && is_good;
    addOptimum(command, graph, optimum ? &*optimum : nullptr, *folders.back());
  }
  const std::string text =
      g2oText(optimum ? optimum->poses : graph.chain(), edgesOf(graph.taken()));
  for (const auto& folder : folders) {
    const bool is_of_file = folder == folders.front() && !file.empty();
    folder->add(is_of_file ? file.filename().string() : "graph.g2o",
                [&](std::ostream& stream) { stream << text; });
  }
  for (const auto& folder : folders)
    folder->commit();
  return is_good ? Good : NotAllOk;
}

int
runTool(int argc, char** argv)
{
  const std::optional<GraphCommand> command = parseGraphCommand(argc, argv);
  return command ? makeGraph(*command) : Good;
}

} // namespace
} // namespace bayesian_icp::app

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp_pose_graph",
                        [&] { return app::runTool(argc, argv); });
}
