#include "register/sgd_run.h"

#include "io/clocks.h"
#include "io/coordinates.h"
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "register/json_values.h"
#include "register/posterior_files.h"
#include "register/progress_bar.h"
#include "register/report_text.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/tree_search.h>

#include <cmath>
#include <optional>

namespace bayesian_icp::app {

namespace {

using nlohmann::ordered_json;

struct SgdRun {
  SgdSettings settings;
  io::CloudFile source;
  io::CloudFile target;
  StochasticGradientIcpResult result;
  /** Of the moved source to the target [m^2], without a gate. */
  double mean_squared_distance = 0.0;
  double reading_seconds = 0.0;
  double registration_seconds = 0.0;
};

double
meanSquaredDistance(const Eigen::Matrix3Xd& source,
                    const KdTree& target,
                    const Vector6d& pose)
{
  Eigen::Matrix3Xd moved;
  movePoints(pose, source, moved);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < moved.cols(); ++i)
    sum += static_cast<double>(
        target
            .nearest(moved.col(i).cast<float>(), std::numeric_limits<float>::infinity())
            .squared_distance);
  return sum / static_cast<double>(moved.cols());
}

SgdRun
registerFiles(const Request& request)
{
  io::silencePcl();
  SgdRun run;
  run.settings = *request.sgd;
  double start = io::wallSeconds();
  run.source = io::readCloud(request.source_file);
  run.target = io::readCloud(request.target_file);
  run.reading_seconds = io::wallSeconds() - start;

  ProgressBar bar(!request.is_quiet, "descending");
  io::catchInterrupt();
  start = io::wallSeconds();
  const Eigen::Matrix3Xd source = io::finitePoints(run.source).cast<double>();
  const KdTree tree(run.target.points);
  const SgdSettings& settings = run.settings;
  run.result = stochasticGradientIcp(
      source,
      TreeSearch(tree, settings.max_distance),
      poseOf(settings.guess),
      settings.options,
      [&](int iteration, const Vector6d&) {
        const long steps = iteration;
        bar.update({0, steps, steps, settings.options.max_iterations});
        return !io::wasInterrupted();
      });
  run.registration_seconds = io::wallSeconds() - start;
  run.mean_squared_distance = meanSquaredDistance(source, tree, run.result.pose);
  return run;
}

std::string
poseTable(const Vector6d& pose)
{
  std::string table;
  for (int k = 0; k < 6; ++k) {
    table += leftAligned(coordinate_names[static_cast<std::size_t>(k)], 6) +
             cell(pose[k], 6, 12) + (k < 3 ? " m" : " rad");
    if (k >= 3)
      table += cell(degrees_per_radian * pose[k], 4, 12) + " deg";
    table += '\n';
  }
  return table;
}

/** The result in words. */
std::string
endText(const SgdRun& run)
{
  const std::string steps = io::textOf(run.result.num_iterations) + " iterations";
  switch (run.result.end) {
  case DescentEnd::Converged:
    return "converged after " + steps;
  case DescentEnd::MaxIterations:
    return "not converged: the pose has not come to rest in " + steps;
  case DescentEnd::TooFewCorrespondences:
    return "failed: too few points of the mini-batches have a target point within the "
           "maximum distance (after " +
           steps + ")";
  case DescentEnd::Diverged:
    return "failed: the descent diverged after " + steps +
           "; a smaller --step-size may help";
  case DescentEnd::Cancelled:
    return "interrupted after " + steps;
  case DescentEnd::InvalidInput:
    break;
  }
  return "failed: the source or the guess cannot be used";
}

/** The table: pose with units, steps, distance, time, matrix. */
std::string
sgdReportText(const SgdRun& run)
{
  std::string text =
      cloudLine("Source: ", run.source) + cloudLine("Target: ", run.target);
  text += "Method: SGD-ICP, " + std::string(toString(run.settings.options.optimizer)) +
          "; no posterior\n";
  text += "Time:   " + io::fixedTextOf(run.registration_seconds, 3) + " s\n";
  text += "\nPose that maps source points into the target frame:\n" +
          poseTable(run.result.pose) + '\n';
  text += wrapped("Status: " + endText(run));
  if (std::isfinite(run.mean_squared_distance))
    text += "Root mean square distance of the source to the target: " +
            io::textOf(std::sqrt(run.mean_squared_distance), 4) + " m\n";
  return text +
         "\nMatrix row by row, for pcl_transform_point_cloud in.pcd out.pcd -matrix "
         "...\n" +
         matrixText(matrixOf(run.result.pose));
}

/** The same and the options as JSON, units in the names of keys. */
std::string
sgdJson(const SgdRun& run)
{
  ordered_json pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[coordinateKey(k)] = run.result.pose[static_cast<Eigen::Index>(k)];
  const ordered_json document = {
      {"schema", "pcl_bayesian_icp/sgd_icp"},
      {"schema_version", 1},
      {"program", {{"name", "pcl_bayesian_icp"}, {"version", BAYESIAN_ICP_VERSION}}},
      {"source", cloudJson(run.source)},
      {"target", cloudJson(run.target)},
      {"frame", "the pose and T_target_source map source points into the target frame"},
      {"end", toString(run.result.end)},
      {"has_converged", run.result.has_converged},
      {"iterations", run.result.num_iterations},
      {"pose", pose},
      {"T_target_source", jsonOf(matrixOf(run.result.pose))},
      {"mean_squared_distance_m2", run.mean_squared_distance},
      {"options", jsonOf(run.settings)},
      {"time",
       {{"reading_s", run.reading_seconds},
        {"registration_s", run.registration_seconds}}}};
  return jsonText(document, 2) + '\n';
}

/** Without a step there is sgd_icp.json alone, which says why, and no older aligned.pcd
 * beside it. */
void
writeFiles(const SgdRun& run, io::OutputFolder& folder)
{
  if (run.result.num_iterations > 0)
    folder.add("aligned.pcd", [&](std::ostream& stream) {
      writeAligned(run.source, run.target, matrixOf(run.result.pose), stream);
    });
  else
    folder.leaveOut("aligned.pcd");
  folder.add("sgd_icp.json", sgdJson(run));
  folder.commit();
}

} // namespace

int
runSgdIcp(const Request& request)
{
  std::optional<io::OutputFolder> folder;
  if (!request.output_folder.empty())
    folder.emplace(request.output_folder);
  const SgdRun run = registerFiles(request);
  const bool has_moved = run.result.num_iterations > 0;
  const bool has_files = has_moved || run.result.end != DescentEnd::Cancelled;
  if (folder && has_files)
    writeFiles(run, *folder);
  if (folder && !has_moved)
    io::tell(std::string("no step was made, so no files ") +
             (has_files ? "but sgd_icp.json " : "") + "are written");
  if (!request.is_quiet)
    io::print(request.is_json ? sgdJson(run) : sgdReportText(run));
  // The table has the status already.
  if (!run.result.has_converged && (request.is_json || request.is_quiet))
    io::tell(endText(run));
  if (io::wasInterrupted())
    return io::Interrupted;
  return run.result.has_converged ? 0 : 1;
}

} // namespace bayesian_icp::app
