#include "register/report_text.h"

#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/data_text.h"
#include "register/text_layout.h"

#include <bayesian_icp/pose.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::app {

namespace {

constexpr std::size_t label_width = 12;
constexpr std::size_t column_width = 12;
constexpr std::size_t diagnostic_width = 10;
const char* const coordinate_labels[] = {
    "x [m]", "y [m]", "z [m]", "roll [rad]", "pitch [rad]", "yaw [rad]"};

/** Mean, deviation and interval, each times \p factor. */
std::string
estimateCells(const CoordinateSummary& coordinate, double factor, int num_decimals)
{
  std::string cells;
  for (const double value : {coordinate.mean,
                             coordinate.standard_deviation,
                             coordinate.quantile_2_5,
                             coordinate.quantile_97_5})
    cells += cell(factor * value, num_decimals, column_width);
  return cells;
}

std::string
coordinateTable(const Summary& summary)
{
  std::string table = std::string(label_width, ' ');
  for (const char* title : {"mean", "std. dev.", "2.5 %", "97.5 %"})
    table += rightAligned(title, column_width);
  for (const char* title : {"R-hat", "bulk ESS", "tail ESS"})
    table += rightAligned(title, diagnostic_width);
  table += '\n';
  for (std::size_t k = 0; k < 6; ++k) {
    const CoordinateSummary& coordinate = summary.coordinates[k];
    table += leftAligned(coordinate_labels[k], label_width) +
             estimateCells(coordinate, 1.0, 6) +
             cell(coordinate.rhat, 3, diagnostic_width) +
             cell(coordinate.bulk_ess, 0, diagnostic_width) +
             cell(coordinate.tail_ess, 0, diagnostic_width) + '\n';
  }
  const char* names_in_degrees[] = {"roll [deg]", "pitch [deg]", "yaw [deg]"};
  for (std::size_t k = 0; k < 3; ++k)
    table += leftAligned(names_in_degrees[k], label_width) +
             estimateCells(summary.coordinates[k + 3], degrees_per_radian, 4) + '\n';
  return table;
}

/** Three lines a mode, each with a translation and an angle. */
std::string
modeText(const Mode& mode, std::size_t number)
{
  std::string text = "Mode " + io::textOf(number) + ": weight " +
                     io::fixedTextOf(mode.weight, 3) + ", chains";
  for (const int chain : mode.chains)
    text += ' ' + io::textOf(chain);
  text += '\n';
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (const Eigen::Index k : {row, row + 3})
      text += leftAligned(std::string(k < 3 ? "  " : "   ") + coordinate_labels[k],
                          label_width + 2) +
              cell(mode.mean[k], 6, column_width) + " +-" +
              cell(std::sqrt(mode.covariance(k, k)), 6, column_width);
    text += '\n';
  }
  return text;
}

std::string
modesText(const std::vector<Mode>& modes)
{
  if (modes.size() < 2)
    return "";
  std::string text =
      "\nModes between which no chain travels, mean +- standard deviation "
      "in each; weights are\nestimates, good to a factor of a few:\n";
  for (std::size_t i = 0; i < modes.size(); ++i)
    text += modeText(modes[i], i + 1);
  return text;
}

/** The argument of `pcl_transform_point_cloud -matrix`: 16 numbers row by row. */
std::string
pasteable(const Eigen::Matrix4d& matrix)
{
  std::string text = "  -matrix ";
  for (Eigen::Index i = 0; i < 16; ++i)
    text += (i > 0 ? "," : "") + io::textOf(matrix(i / 4, i % 4), 9);
  return text + '\n';
}

std::string
cloudLine(const char* role, const io::CloudFile& cloud)
{
  const auto num_points = static_cast<std::size_t>(cloud.points.cols());
  std::string line =
      std::string(role) + cloud.file + ", " + std::to_string(num_points) + " points";
  if (cloud.num_finite < num_points)
    line += ", " + std::to_string(cloud.num_finite) + " of them finite";
  return line + '\n';
}

std::string
icpLine(const RegistrationResult& result)
{
  std::string line = "ICP:    ";
  line += result.icp_has_converged ? "converged" : "did not converge";
  if (result.icp_fitness < std::numeric_limits<double>::max())
    line += ", root mean square distance of the source to the target " +
            io::textOf(std::sqrt(result.icp_fitness), 4) + " m";
  return line + '\n';
}

} // namespace

std::string
statusText(const Summary& summary)
{
  std::string name = toString(summary.status);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + ": " + summary.message;
}

std::string
reportText(const Run& run)
{
  const RegistrationResult& result = run.result;
  const Summary& summary = result.summary;
  std::string text =
      cloudLine("Source: ", run.source) + cloudLine("Target: ", run.target);
  text += "Time:   ICP " + io::fixedTextOf(result.icp_seconds, 2) + " s, sampling " +
          io::fixedTextOf(result.sampling_seconds, 2) + " s\n";
  if (summary.num_draws > 0)
    text += "\nPosterior of the pose that maps source points into the target frame, " +
            std::to_string(summary.num_draws) + " draws of " +
            std::to_string(summary.num_chains - summary.num_diverged_chains) +
            " chains:\n" + coordinateTable(summary) + modesText(summary.modes) +
            dataText(summary.data);
  text += "\n" + wrapped("Status: " + statusText(summary)) + icpLine(result);
  text += "\nMatrices row by row, for pcl_transform_point_cloud in.pcd out.pcd -matrix "
          "...\n";
  if (summary.num_draws > 0)
    text += "Posterior mean:\n" + pasteable(matrixOf(summary.mean));
  text += std::string("Final transformation (") +
          (result.is_final_the_mean ? "the posterior mean" : "ICP's result") + "):\n" +
          pasteable(result.final_matrix);
  return text;
}

} // namespace bayesian_icp::app
