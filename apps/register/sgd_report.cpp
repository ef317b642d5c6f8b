#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/json_values.h"
#include "register/posterior_json.h"
#include "register/report_text.h"
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
  // Names of files need not be UTF-8.
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

} // namespace bayesian_icp::app
