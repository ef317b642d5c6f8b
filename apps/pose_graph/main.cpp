/** \file
 * \brief pcl_bayesian_icp_pose_graph: consecutive scans in, a pose graph for g2o out.
 */
#include "io/cloud_file.h"
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "pose_graph/graph_command.h"

#include <filesystem>
#include <iostream>

namespace bayesian_icp::app {
namespace {

/** Failures have those of io::explainFailure(). */
enum ExitCode { Good = 0, NotAllOk = 1, Interrupted = io::interrupted_exit_code };

void
tell(const std::string& message)
{
  std::cerr << "pcl_bayesian_icp_pose_graph: " + message + '\n';
}

int
makeGraph(const GraphCommand& command)
{
  if (!command.note.empty() && !command.is_quiet)
    tell("note: " + command.note);
  io::silencePcl();
  io::OutputFolder folder(io::folderOf(command.output_file));
  ScanGraph graph(command.request, [&](bool is_ok, const std::string& line) {
    if (!is_ok || !command.is_quiet)
      tell(line);
  });
  io::catchInterrupt();
  graph.registerScans();
  if (io::wasInterrupted())
    return Interrupted;
  folder.add(std::filesystem::path(command.output_file).filename().string(),
             [&](std::ostream& stream) { stream << graph.g2oText(); });
  folder.commit();
  return graph.numNotOk() == 0 ? Good : NotAllOk;
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
