/** \file
 * \brief pcl_bayesian_icp_viewer: shows a registration and how sure it is.
 */
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/posterior_file.h"
#include "io/program.h"
#include "register/progress_bar.h"
#include "register/report_text.h"
#include "viewer/command_line.h"
#include "viewer/drawing.h"

#include <bayesian_icp/summary.h>

#include <filesystem>
#include <optional>

namespace bayesian_icp::viewer {
namespace {

void
takeClouds(const io::CloudFile& source, const io::CloudFile& target, Scene& scene)
{
  scene.source = io::finitePoints(source).cast<double>();
  scene.target = io::finitePoints(target).cast<double>();
  scene.num_source_points = source.points.cols();
  scene.num_target_points = target.points.cols();
  scene.sensor_origin = target.sensor_origin.head<3>().cast<double>();
  scene.source_file = source.file;
  scene.target_file = target.file;
}

/** \p given, or else the cloud that a posterior names, which may have moved, or the
 * user. A relative name is of the current folder, or else of the posterior's. */
io::CloudFile
readCloudOf(const std::filesystem::path& posterior_file,
            const std::string& named,
            const std::string& given)
{
  if (!given.empty())
    return io::readCloud(given);
  std::error_code unknown;
  for (const std::filesystem::path& file :
       {std::filesystem::path(named), posterior_file.parent_path() / named})
    if (std::filesystem::exists(file, unknown))
      return io::readCloud(file.string());
  throw io::FileError(named,
                      "no such file, though " + posterior_file.string() +
                          " names it; say on the command line where both clouds are");
}

/** Whether the draws have the mean and the deviations that a posterior states. The
 * draws of two runs differ by more, those of another computer by less. */
bool
haveMoments(const io::PosteriorFile& posterior, const PoseMatrix& draws)
{
  constexpr double share_of_deviation = 1e-3;
  constexpr double rounding = 1e-9; // [m, rad]
  constexpr auto convention = CovarianceConvention::RightSE3;
  const auto deviationsOf =
      [](const Matrix6d& covariance) -> Eigen::Array<double, 6, 1> {
    return covariance.diagonal().array().sqrt();
  };
  const Vector6d mean = meanPose(draws);
  const auto found = deviationsOf(covarianceAbout(mean, draws, convention));
  const auto stated = deviationsOf(posterior.covariance(convention));
  const Vector6d shift = poseError(mean, posterior.mean, convention);
  const auto tolerance = share_of_deviation * stated + rounding;
  // A single draw has no deviations: NaN, which does not speak against it.
  return !(shift.array().abs() > tolerance || (found - stated).abs() > tolerance).any();
}

/** Clouds and guess of a run, and what came of it if it has taken place. */
Scene
sceneOf(const app::Run& run)
{
  Scene scene;
  takeClouds(run.source, run.target, scene);
  scene.guess = run.settings.guess;
  scene.final_matrix = run.result.final_matrix;
  scene.draws = pooledDraws(run.result.chains);
  scene.is_ok = run.result.summary.status == Status::Ok;
  scene.status_text = app::statusText(run.result.summary);
  return scene;
}

/** A saved posterior, with samples.csv from beside it. */
Scene
readScene(const Request& request)
{
  const io::PosteriorFile posterior = io::readPosterior(request.posterior_file);
  const std::filesystem::path path = request.posterior_file;
  Scene scene;
  const io::CloudFile source =
      readCloudOf(path, posterior.source_file, request.source_file);
  takeClouds(
      source, readCloudOf(path, posterior.target_file, request.target_file), scene);
  scene.guess = posterior.guess;
  scene.final_matrix = posterior.final_matrix;
  if (posterior.num_draws > 0)
    scene.draws = io::readSamples((path.parent_path() / "samples.csv").string());
  scene.is_ok = posterior.status == toString(Status::Ok);
  scene.status_text = app::statusText(posterior.status, posterior.status_message);
  const auto note = [&scene](const std::string& text) {
    scene.note +=
        (scene.note.empty() ? "warning: not of one registration: " : "; ") + text;
  };
  const auto compare =
      [&](const std::string& what, Eigen::Index found, Eigen::Index stated) {
        if (found != stated)
          note(what + " has " + io::textOf(found) + " in place of the " +
               io::textOf(stated) + " of " + path.filename().string());
      };
  compare("the source", scene.num_source_points, posterior.num_source_points);
  compare("the target", scene.num_target_points, posterior.num_target_points);
  compare("samples.csv", scene.draws.rows(), posterior.num_draws);
  if (scene.draws.rows() == posterior.num_draws && !haveMoments(posterior, scene.draws))
    note("samples.csv has another mean or other deviations than " +
         path.filename().string());
  return scene;
}

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
    Scene scene = readScene(request);
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
  if (!request.settings.note.empty() && !request.is_quiet)
    io::tell("note: " + request.settings.note);
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
    return viewer::show(viewer::parseCommandLine(argc, argv));
  });
}
