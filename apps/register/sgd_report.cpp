#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/json_values.h"
#include "register/posterior_json.h"
#include "register/sgd_run.h"
#include "register/text_layout.h"

#include <cmath>

namespace bayesian_icp::app {

namespace {

using nlohmann::ordered_json;

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

std::string
cloudLine(const char* role, const io::CloudFile& cloud)
{
  return role + cloud.file + ", " + io::textOf(cloud.num_finite) + " finite points\n";
}

double
usedStepSize(const StochasticGradientIcpOptions& options)
{
  return std::isnan(options.step_size) ? defaultStepSize(options.optimizer)
                                       : options.step_size;
}

ordered_json
optionsJson(const SgdRequest& request)
{
  const auto& options = request.options;
  return {{"optimizer", toString(options.optimizer)},
          {"step_size", jsonOf(usedStepSize(options))},
          {"batch_size", options.batch_size},
          {"max_iterations", options.max_iterations},
          {"max_distance_m", jsonOf(request.max_distance)},
          {"is_one_to_one", options.is_one_to_one},
          {"translation_epsilon_m", options.translation_epsilon},
          {"rotation_epsilon_rad", options.rotation_epsilon},
          {"still_iterations", options.num_still_iterations},
          {"seed", options.seed},
          {"guess_matrix", jsonOf(request.guess)}};
}

} // namespace

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

std::string
sgdReportText(const SgdRun& run)
{
  std::string text =
      cloudLine("Source: ", run.source) + cloudLine("Target: ", run.target);
  text += "Method: SGD-ICP, " + std::string(toString(run.request.options.optimizer)) +
          "; no posterior\n";
  text += "Time:   " + io::fixedTextOf(run.registration_seconds, 3) + " s\n";
  text += "\nPose that maps source points into the target frame:\n" +
          poseTable(run.result.pose) + '\n';
  text += wrapped("Status: " + endText(run));
  if (std::isfinite(run.mean_squared_distance))
    text += "Root mean square distance of the source to the target: " +
            io::textOf(std::sqrt(run.mean_squared_distance), 4) + " m\n";
  text += "\nMatrix row by row, for pcl_transform_point_cloud in.pcd out.pcd -matrix "
          "...\n  -matrix ";
  const Eigen::Matrix4d T = matrixOf(run.result.pose);
  for (Eigen::Index i = 0; i < 16; ++i)
    text += (i > 0 ? "," : "") + io::textOf(T(i / 4, i % 4), 9);
  return text + '\n';
}

std::string
sgdJson(const SgdRun& run)
{
  ordered_json pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[coordinateKey(k)] = jsonOf(run.result.pose[static_cast<Eigen::Index>(k)]);
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
      {"mean_squared_distance_m2", jsonOf(run.mean_squared_distance)},
      {"options", optionsJson(run.request)},
      {"time",
       {{"reading_s", run.reading_seconds},
        {"registration_s", run.registration_seconds}}}};
  // Names of files need not be UTF-8.
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

} // namespace bayesian_icp::app
