#include "report/tables.h"

#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/data_text.h"

#include <pcl/pcl_config.h>

#include <cmath>

namespace bayesian_icp::app {

namespace {

constexpr double per_thousand = 1e3;
/** Decimals of metres and radians, and of degrees. */
constexpr int num_decimals = 6;
constexpr int num_decimals_in_degrees = 4;

using Cells = std::vector<std::string>;

std::string
numberText(double value, int decimals)
{
  constexpr double largest_in_full = 1e9;
  if (!std::isfinite(value))
    return "–";
  return std::abs(value) < largest_in_full ? io::fixedTextOf(value, decimals)
                                           : io::textOf(value, 5);
}

std::string
nameWithUnit(int k, const char* unit_of_angles)
{
  return std::string(coordinate_names[static_cast<std::size_t>(k)]) + " [" +
         (isAngle(k) ? unit_of_angles : "m") + ']';
}

void
addEstimate(const CoordinateSummary& coordinate,
            double factor,
            int decimals,
            Cells& cells)
{
  for (const double value : {coordinate.mean,
                             coordinate.standard_deviation,
                             coordinate.quantile_2_5,
                             coordinate.quantile_97_5})
    cells.push_back(numberText(factor * value, decimals));
}

std::string
cloudText(const io::CloudFile& cloud)
{
  return cloud.file + ", " + io::textOf(cloud.points.cols()) + " points, " +
         io::textOf(cloud.num_finite) + " of them finite";
}

std::string
icpText(const RegistrationResult& result)
{
  std::string text = result.icp_has_converged ? "converged" : "did not converge";
  if (result.icp_fitness < std::numeric_limits<double>::max())
    text += ", root mean square distance of the source to the target " +
            io::textOf(std::sqrt(result.icp_fitness), 4) + " m";
  return text;
}

} // namespace

html::Table
poseTable(const Summary& summary)
{
  html::Table table;
  table.caption = "Pose that maps source points into the target frame; R = Rz(yaw) "
                  "Ry(pitch) Rx(roll)";
  table.header = {
      "", "mean", "std. dev.", "2.5 %", "97.5 %", "R-hat", "bulk ESS", "tail ESS"};
  for (int k = 0; k < 6; ++k) {
    const CoordinateSummary& coordinate =
        summary.coordinates[static_cast<std::size_t>(k)];
    Cells cells = {nameWithUnit(k, "rad")};
    addEstimate(coordinate, 1.0, num_decimals, cells);
    cells.push_back(numberText(coordinate.rhat, 3));
    cells.push_back(numberText(coordinate.bulk_ess, 0));
    cells.push_back(numberText(coordinate.tail_ess, 0));
    table.rows.push_back(cells);
  }
  for (int k = 3; k < 6; ++k) {
    Cells cells = {nameWithUnit(k, "°")};
    addEstimate(summary.coordinates[static_cast<std::size_t>(k)],
                degrees_per_radian,
                num_decimals_in_degrees,
                cells);
    cells.resize(table.header.size());
    table.rows.push_back(cells);
  }
  return table;
}

html::Table
modesTable(const std::vector<Mode>& modes)
{
  html::Table table;
  table.caption = "Modes between which no chain travels: mean ± standard deviation in "
                  "each; weights are estimates, good to a factor of a few";
  table.header = {"mode", "weight", "chains"};
  for (int k = 0; k < 6; ++k)
    table.header.push_back(nameWithUnit(k, "°"));
  for (std::size_t i = 0; i < modes.size(); ++i) {
    std::string chains;
    for (const int chain : modes[i].chains)
      chains += (chains.empty() ? "" : ", ") + io::textOf(chain);
    Cells cells = {io::textOf(i + 1), io::fixedTextOf(modes[i].weight, 3), chains};
    for (int k = 0; k < 6; ++k) {
      const double factor = isAngle(k) ? degrees_per_radian : 1.0;
      cells.push_back(numberText(factor * modes[i].mean[k], 4) + " ± " +
                      numberText(factor * std::sqrt(modes[i].covariance(k, k)), 4));
    }
    table.rows.push_back(cells);
  }
  return table;
}

html::Table
directionsTable(const std::vector<DataDirection>& directions)
{
  html::Table table;
  table.caption = "Six independent motions, best known first; standard deviations as "
                  "root mean square displacement of the source's points, and as angle";
  table.header = {"", "std. dev. [mm]", "[mrad]", "prior [mm]", "held by", "motion"};
  table.first_column_of_words = 4;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const DataDirection& direction = directions[i];
    table.rows.push_back(
        {io::textOf(i + 1),
         numberText(per_thousand * direction.standard_deviation, 3),
         numberText(per_thousand * angularDeviation(direction), 3),
         numberText(per_thousand * direction.prior_standard_deviation, 1),
         holderOf(direction.observability),
         direction.description});
  }
  return table;
}

html::Table
runTable(const Run& run)
{
  const RegistrationResult& result = run.result;
  html::Table table;
  table.caption = "The run";
  table.header = {"", ""};
  table.first_column_of_words = 1;
  const std::string icp_time =
      result.has_icp ? "ICP " + io::fixedTextOf(result.icp_seconds, 2) + " s, " : "";
  table.rows = {
      {"source", cloudText(run.source)},
      {"target", cloudText(run.target)},
      {"ICP", result.has_icp ? icpText(result) : "was not run"},
      {"final transformation",
       result.is_final_the_mean ? "the posterior mean" : "ICP's result"},
      {"time",
       icp_time + "sampling " + io::fixedTextOf(result.sampling_seconds, 2) + " s"},
      {"versions",
       "pcl_bayesian_icp " BAYESIAN_ICP_VERSION ", PCL " PCL_VERSION_PRETTY ", Eigen " +
           io::textOf(EIGEN_WORLD_VERSION) + '.' + io::textOf(EIGEN_MAJOR_VERSION) +
           '.' + io::textOf(EIGEN_MINOR_VERSION)}};
  return table;
}

} // namespace bayesian_icp::app
