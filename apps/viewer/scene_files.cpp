#include "viewer/scene_files.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "io/posterior_file.h"
#include "register/report_text.h"

#include <bayesian_icp/summary.h>

#include <filesystem>

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
  for (const std::filesystem::path& file :
       {std::filesystem::path(named), posterior_file.parent_path() / named})
    if (std::filesystem::exists(file))
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

} // namespace

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

Scene
readScene(const std::string& posterior_file,
          const std::string& source_file,
          const std::string& target_file)
{
  const io::PosteriorFile posterior = io::readPosterior(posterior_file);
  const std::filesystem::path path = posterior_file;
  Scene scene;
  const io::CloudFile source = readCloudOf(path, posterior.source_file, source_file);
  const io::CloudFile target = readCloudOf(path, posterior.target_file, target_file);
  takeClouds(source, target, scene);
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

} // namespace bayesian_icp::viewer
