#include "register/posterior_files.h"

#include "io/coordinates.h"
#include "io/numbers.h"
#include "io/posterior_file.h"
#include "register/json_values.h"
#include "register/report_text.h"
#include "register/settings_json.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Cholesky>

#include <cmath>
#include <ostream>

namespace bayesian_icp::app {

namespace {

using nlohmann::ordered_json;

/** A convention of a covariance in words. */
struct Convention {
  CovarianceConvention convention;
  std::array<const char*, 6> order;
  const char* meaning;
};

/** In the order of the enumeration. */
const Convention conventions[] = {
    {CovarianceConvention::Parameters,
     {"x", "y", "z", "roll", "pitch", "yaw"},
     "errors of the parameters: translation in the target frame, angles of "
     "R = Rz(yaw) Ry(pitch) Rx(roll)"},
    {CovarianceConvention::R3xSO3,
     {"t_x", "t_y", "t_z", "w_x", "w_y", "w_z"},
     "error t of the translation in the target frame, t_mean + t, and a small rotation "
     "w "
     "about the target's fixed axes, R = exp(w) R_mean: ROS PoseWithCovariance"},
    {CovarianceConvention::LeftSE3,
     {"v_x", "v_y", "v_z", "w_x", "w_y", "w_z"},
     "twist (v, w) in the target frame, T = exp(xi) T_mean"},
    {CovarianceConvention::RightSE3,
     {"v_x", "v_y", "v_z", "w_x", "w_y", "w_z"},
     "twist (v, w) in the source frame, T = T_mean exp(xi): the convention of GTSAM, "
     "which puts the rotation first"}};

ordered_json
coordinatesJson(const Summary& summary)
{
  auto list = ordered_json::array();
  for (std::size_t k = 0; k < 6; ++k) {
    const CoordinateSummary& coordinate = summary.coordinates[k];
    list.push_back({{"name", coordinate_names[k]},
                    {"unit", k < 3 ? "m" : "rad"},
                    {"mean", coordinate.mean},
                    {"standard_deviation", coordinate.standard_deviation},
                    {"quantile_2.5_percent", coordinate.quantile_2_5},
                    {"median", coordinate.median},
                    {"quantile_97.5_percent", coordinate.quantile_97_5},
                    {"rhat", coordinate.rhat},
                    {"bulk_ess", coordinate.bulk_ess},
                    {"tail_ess", coordinate.tail_ess},
                    {"mcse_of_mean", coordinate.mcse}});
  }
  return list;
}

ordered_json
modeJson(const Mode& mode)
{
  return {{"weight", mode.weight},
          {"chains", mode.chains},
          {"mean", meanJson(mode.mean)},
          {"covariance",
           covarianceJson(CovarianceConvention::Parameters,
                          mode.covariance(CovarianceConvention::Parameters))}};
}

ordered_json
chainsJson(const std::vector<Chain>& chains)
{
  auto list = ordered_json::array();
  for (std::size_t i = 0; i < chains.size(); ++i)
    list.push_back({{"chain", i},
                    {"draws", chains[i].draws.rows()},
                    {"has_diverged", chains[i].diverged}});
  return list;
}

ordered_json
posteriorOf(const RegistrationResult& result)
{
  const auto covarianceOf = [&result](const Convention& convention) {
    return covarianceJson(convention.convention,
                          result.summary.covariance(convention.convention));
  };
  return {{"draws", result.summary.num_draws},
          {"draws_note",
           "draws of chains that have diverged are left out here and in samples.csv"},
          {"mean", meanJson(result.summary.mean)},
          {"coordinates", coordinatesJson(result.summary)},
          {"covariances", listOf(conventions, covarianceOf)},
          {"modes", listOf(result.summary.modes, modeJson)},
          {"modes_note",
           "weights are estimates, accurate to a factor of a few; mean and covariances "
           "of the whole posterior mix modes in proportion to their draws; preset "
           "paper does not search for modes"},
          {"chains", chainsJson(result.chains)}};
}

ordered_json
directionJson(const DataDirection& direction)
{
  return {{"description", direction.description},
          {"observability", toString(direction.observability)},
          {"standard_deviation_m", direction.standard_deviation},
          {"prior_standard_deviation_m", direction.prior_standard_deviation},
          {"information_in_units_of_the_prior", direction.relative_information},
          {"twist", jsonOf(direction.twist)}};
}

ordered_json
flagsJson(const DataFlags& flags)
{
  ordered_json json;
  for (const DataFlag& flag : data_flags)
    json[flag.key] = flags.*flag.is_raised;
  return json;
}

/** What the clouds say about the pose, units in the names of keys; null if nothing. */
ordered_json
dataJson(const DataReport& report)
{
  if (!report.is_available)
    return nullptr;
  return {
      {"noise_scale_m", report.noise_scale},
      {"noise_scale_in_units_of_the_target", report.residual_scale},
      {"effective_patches", report.effective_patches},
      {"degrees_of_freedom", report.degrees_of_freedom},
      {"correlation_factor", report.correlation_factor},
      {"active_fraction", report.active_fraction},
      {"active_fraction_of_target", report.active_fraction_of_target},
      {"basin_distance_in_standard_deviations", report.basin_distance},
      {"other_start_cost_ratio", report.other_cost_ratio},
      {"prior_probability", report.prior_probability},
      {"flags", flagsJson(report.flags)},
      {"flag_messages", describeFlags(report)},
      {"centre_m", jsonOf(report.centre)},
      {"directions", listOf(report.directions, directionJson)},
      {"directions_note",
       "best known first; twist (v, w) [1, rad/m] in the target frame, T = exp(xi) T "
       "about centre_m, of unit root mean squared displacement of the source's points: "
       "a standard deviation in m along it is |w| times as many rad"}};
}

/** Root mean square distance between the finite points moved by \p a and by \p b [m].
 */
double
distanceBetween(const Eigen::Matrix4d& a,
                const Eigen::Matrix4d& b,
                const io::CloudFile& cloud)
{
  const Eigen::Matrix<double, 3, 4> difference = (a - b).topRows<3>();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    const Eigen::Vector3d point = cloud.points.col(i).cast<double>();
    if (point.allFinite())
      sum += (difference * point.homogeneous()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(cloud.num_finite));
}

} // namespace

std::optional<FinalPlace>
finalPlace(const Run& run)
{
  constexpr double excluded = 27.9; // chi-square, 6 degrees of freedom, 99.99 %
  const RegistrationResult& result = run.result;
  const Summary& summary = result.summary;
  if (summary.status != Status::Ok && summary.status != Status::Doubtful)
    return std::nullopt;
  const Vector6d error = poseError(bayesian_icp::poseOf(result.final_matrix),
                                   summary.mean,
                                   CovarianceConvention::RightSE3);
  const Matrix6d& covariance = summary.covariance(CovarianceConvention::RightSE3);
  return FinalPlace{
      error.dot(covariance.ldlt().solve(error)) < excluded,
      distanceBetween(result.final_matrix, matrixOf(summary.mean), run.source)};
}

ordered_json
cloudJson(const io::CloudFile& cloud)
{
  return {{"file", cloud.file},
          {"points", cloud.points.cols()},
          {"finite_points", cloud.num_finite}};
}

ordered_json
icpJson(const RegistrationResult& result)
{
  const bool has_fitness = result.icp_fitness < std::numeric_limits<double>::max();
  return {{"has_converged", result.icp_has_converged},
          {"mean_squared_distance_m2", has_fitness ? result.icp_fitness : std::nan("")},
          {"T_target_source", jsonOf(result.icp_matrix)}};
}

ordered_json
meanJson(const Vector6d& mean)
{
  ordered_json json;
  for (std::size_t k = 0; k < 6; ++k)
    json[coordinateKey(k)] = mean[static_cast<Eigen::Index>(k)];
  json["T_target_source"] = jsonOf(matrixOf(mean));
  return json;
}

ordered_json
timeJson(const Run& run)
{
  return {{"reading_s", run.reading_seconds},
          {"icp_s", run.result.icp_seconds},
          {"sampling_s", run.result.sampling_seconds}};
}

ordered_json
finalTransformationJson(const Run& run)
{
  ordered_json json = {
      {"is", run.result.is_final_the_mean ? "posterior mean" : "ICP's result"},
      {"T_target_source", jsonOf(run.result.final_matrix)},
      {"is_within_posterior", nullptr},
      {"distance_from_mean_m", nullptr}};
  if (const auto place = finalPlace(run)) {
    json["is_within_posterior"] = place->is_within_posterior;
    json["distance_from_mean_m"] = place->distance_from_mean;
  }
  return json;
}

ordered_json
covarianceJson(CovarianceConvention convention, const Matrix6d& matrix)
{
  const Convention& words = conventions[static_cast<std::size_t>(convention)];
  return {{"convention", toString(convention)},
          {"order", words.order},
          {"units", {"m", "m", "m", "rad", "rad", "rad"}},
          {"meaning", words.meaning},
          {"matrix", jsonOf(matrix)}};
}

std::string
posteriorJson(const Run& run)
{
  const RegistrationResult& result = run.result;
  const ordered_json document = {
      {"schema", io::posterior_schema_name},
      {"schema_version", io::posterior_schema_version},
      {"program", {{"name", "pcl_bayesian_icp"}, {"version", BAYESIAN_ICP_VERSION}}},
      {"source", cloudJson(run.source)},
      {"target", cloudJson(run.target)},
      {"frame", "poses and T_target_source map source points into the target frame"},
      {"status",
       {{"name", toString(result.summary.status)},
        {"message", result.summary.message}}},
      {"final_transformation", finalTransformationJson(run)},
      {"icp", icpJson(result)},
      {"posterior", posteriorOf(result)},
      {"data", dataJson(result.summary.data)},
      {"options", jsonOf(run.settings)},
      {"prior_frame",
       toString(priorFrameOf(run.settings.options, run.source.points.cast<double>()))},
      {"time", timeJson(run)}};
  return jsonText(document, 2) + '\n';
}

void
writeSamples(const std::vector<Chain>& chains, std::ostream& stream)
{
  stream << io::samples_header << '\n';
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (chains[i].diverged)
      continue;
    for (Eigen::Index draw = 0; draw < chains[i].draws.rows(); ++draw) {
      std::string line = io::textOf(i) + ',' + io::textOf(draw);
      for (int k = 0; k < 6; ++k)
        line += ',' + io::textOf(chains[i].draws(draw, k), 17);
      stream << line << '\n';
    }
  }
}

void
addPosteriorFiles(const Run& run, io::OutputFolder& folder)
{
  if (run.result.summary.num_draws > 0)
    folder.add("samples.csv",
               [&](std::ostream& stream) { writeSamples(run.result.chains, stream); });
  else
    folder.leaveOut("samples.csv");
  folder.add("posterior.json", posteriorJson(run));
}

} // namespace bayesian_icp::app
