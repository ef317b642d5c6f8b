/** \file
 * \brief pcl_bayesian_icp_viewer: shows a registration and how sure it is.
 */
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "register/progress_bar.h"
#include "viewer/command_line.h"
#include "viewer/display.h"
#include "viewer/drawing.h"
#include "viewer/live_view.h"
#include "viewer/scene_files.h"

#include <filesystem>
#include <optional>

namespace bayesian_icp::viewer {
namespace {

void
letUserLook(Window& window)
{
  window.handleKeys();
  while (!window.isClosed() && !io::wasInterrupted())
    window.spinOnce(50);
}

int
exitCodeFor(const Scene& scene)
{
  if (io::wasInterrupted())
    return io::Interrupted;
  return scene.is_ok && scene.note.empty() ? io::Good : io::NotGood;
}

/** Opens the window, or the picture that stands in for it. */
void
openWindow(const Request& request,
           const std::vector<std::string>& cloud_files,
           std::optional<Window>& window)
{
  window.emplace(request.view, cloud_files);
  if (!request.view.isOffScreen() && !request.is_quiet)
    io::print("pcl_bayesian_icp_viewer: press h in the window for its keys\n");
}

/** Registers where there is no saved posterior. */
Scene
prepareScene(const Request& request, std::optional<Window>& window)
{
  if (!request.posterior_file.empty()) {
    Scene scene =
        readScene(request.posterior_file, request.source_file, request.target_file);
    if (!scene.note.empty())
      io::tell(scene.note);
    requireDisplay();
    return scene;
  }
  app::Run run =
      app::readRun(request.source_file, request.target_file, request.settings);
  requireDisplay();
  if (request.view.is_live) {
    openWindow(request, {request.source_file, request.target_file}, window);
    registerLive(sceneOf(run), request.view, *window, run);
  }
  else
    app::registerWithBar(!request.is_quiet, run);
  return sceneOf(run);
}

int
show(const Request& request)
{
  io::silencePcl();
  if (!request.note.empty() && !request.is_quiet)
    io::tell("note: " + request.note);
  // It is known before the work whether the picture can be written.
  std::optional<io::OutputFolder> folder;
  const std::filesystem::path file = request.view.screenshot_file;
  if (request.view.isOffScreen()) {
    folder.emplace(io::folderOf(file));
    folder->fileOf(file.filename());
  }
  io::catchInterrupt();
  std::optional<Window> window;
  Scene scene = prepareScene(request, window);
  if (io::wasInterrupted() || (window && window->isClosed()))
    return exitCodeFor(scene);
  if (!window)
    openWindow(request, {scene.source_file, scene.target_file}, window);
  // A live screenshot is of the chains, which are in the window already.
  if (!(folder && request.view.is_live)) {
    scene.uncertainty = uncertaintyOf(scene, request.view);
    drawScene(scene, request.view, *window);
  }
  if (folder)
    window->save(file.filename(), *folder);
  else
    letUserLook(*window);
  if (!scene.is_ok)
    io::tell(scene.status_text);
  return exitCodeFor(scene);
}

} // namespace
} // namespace bayesian_icp::viewer

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp_viewer", [&]() -> int {
    const auto request = viewer::parseCommandLine(argc, argv);
    return request ? viewer::show(*request) : io::Good;
  });
}
