#include "register/report_text.h"

#include "io/cloud_file.h"
#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/posterior_files.h"

#include <bayesian_icp/pose.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp::app {

namespace {

constexpr std::size_t label_width = 12;
constexpr std::size_t column_width = 12;
constexpr std::size_t diagnostic_width = 10;
constexpr std::size_t direction_width = 11;
/** Of the column "held by". */
constexpr std::size_t holder_width = 7;
constexpr double millimetres = 1e3;
constexpr double milliradians = 1e3;

/** At least one blank, and \p text, \p width characters or more. */
std::string
rightAligned(const std::string& text, std::size_t width)
{
  return std::string(width > text.size() ? width - text.size() : 1, ' ') + text;
}

std::string
coordinateTable(const Summary& summary)
{
  constexpr std::size_t num_wide_columns = 4;
  std::vector<std::vector<std::string>> rows = coordinateCells(summary, "deg", "-");
  rows.insert(rows.begin(),
              {"",
               "mean pose",
               "std. dev.",
               "2.5 %",
               "97.5 %",
               "R-hat",
               "bulk ESS",
               "tail ESS"});
  std::string table;
  for (const auto& row : rows) {
    table += leftAligned(row[0], label_width);
    for (std::size_t i = 1; i < row.size(); ++i)
      table +=
          rightAligned(row[i], i <= num_wide_columns ? column_width : diagnostic_width);
    table += '\n';
  }
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
  const Matrix6d& covariance = mode.covariance(CovarianceConvention::Parameters);
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (const Eigen::Index k : {row, row + 3})
      text +=
          leftAligned((k < 3 ? "  " : "   ") + nameWithUnit(static_cast<int>(k), "rad"),
                      label_width + 2) +
          cell(mode.mean[k], 6, column_width) + " +-" +
          cell(std::sqrt(covariance(k, k)), 6, column_width);
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
      "\nModes between which no chain travels, mean +- standard deviation in each; "
      "weights are\nestimates, accurate to a factor of a few:\n";
  for (std::size_t i = 0; i < modes.size(); ++i)
    text += modeText(modes[i], i + 1);
  return text;
}

/** Deviations as displacement, and as angle where the motion is not a translation. */
std::string
directionRow(const DataDirection& direction)
{
  return cell(millimetres * direction.standard_deviation, 3, direction_width) +
         cell(milliradians * angularDeviation(direction), 3, direction_width) +
         cell(millimetres * direction.prior_standard_deviation, 1, direction_width) +
         "  " + leftAligned(holderOf(direction.observability), holder_width) + "  " +
         direction.description + '\n';
}

/** A table of directions, the noise that was found, support and flags; empty if there
 * is no report. */
std::string
dataText(const DataReport& report)
{
  if (!report.is_available)
    return "";
  std::string text = "\nHow well the clouds hold the pose, best known first (root mean "
                     "square displacement of\nthe source's points, and angle):\n";
  for (const char* title : {"sd [mm]", "sd [mrad]", "prior [mm]"})
    text += rightAligned(title, direction_width);
  text += "  held by  motion\n";
  for (const DataDirection& direction : report.directions)
    text += directionRow(direction);
  const std::string flags = flagNames(report.flags);
  return text + "Noise:   " + io::textOf(millimetres * report.noise_scale, 4) +
         " mm from the surface, " + io::fixedTextOf(report.residual_scale, 2) +
         " times the target's own\nPatches: about " +
         io::fixedTextOf(report.effective_patches, 0) +
         " independent ones, correlation factor " +
         io::fixedTextOf(report.correlation_factor, 2) +
         "\nSupport: " + describeSupport(report) +
         "\nFlags:   " + (flags.empty() ? "none" : flags) + '\n';
}

} // namespace

std::vector<std::vector<std::string>>
coordinateCells(const Summary& summary,
                const std::string& degree,
                const std::string& unknown)
{
  std::vector<std::vector<std::string>> rows;
  const Vector6d mean_pose = meanPoseCoordinates(summary);
  const auto addRow = [&](int k, const std::string& unit, double factor, int decimals) {
    const CoordinateSummary& c = summary.coordinates[static_cast<std::size_t>(k)];
    rows.push_back({nameWithUnit(k, unit)});
    for (const double value :
         {mean_pose[k], c.standard_deviation, c.quantile_2_5, c.quantile_97_5})
      rows.back().push_back(numberText(factor * value, decimals, unknown));
  };
  for (int k = 0; k < 6; ++k) {
    addRow(k, "rad", 1.0, 6);
    const CoordinateSummary& c = summary.coordinates[static_cast<std::size_t>(k)];
    rows.back().push_back(numberText(c.rhat, 3, unknown));
    rows.back().push_back(numberText(c.bulk_ess, 0, unknown));
    rows.back().push_back(numberText(c.tail_ess, 0, unknown));
  }
  for (int k = 3; k < 6; ++k)
    addRow(k, degree, degrees_per_radian, 4);
  return rows;
}

Vector6d
meanPoseCoordinates(const Summary& summary)
{
  Vector6d mean = summary.mean;
  for (int k = 3; k < 6; ++k) {
    const double nearby = summary.coordinates[static_cast<std::size_t>(k)].mean;
    mean[k] = nearby + wrapAngle(mean[k] - nearby);
  }
  return mean;
}

std::string
nameWithUnit(int coordinate, const std::string& unit_of_angles)
{
  return coordinate_names[static_cast<std::size_t>(coordinate)] +
         (isAngle(coordinate) ? " [" + unit_of_angles + ']' : " [m]");
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

std::string
icpNote(const Run& run)
{
  const RegistrationResult& result = run.result;
  if (!result.has_icp || result.is_final_the_mean)
    return "";
  const auto place = finalPlace(run);
  if (!place || (result.icp_has_converged && place->is_within_posterior))
    return "";
  return std::string("the final transformation is ICP's result") +
         (result.icp_has_converged ? "" : ", and ICP did not converge") +
         (place->is_within_posterior ? "" : "; the posterior excludes it") +
         "; it moves the points " +
         io::textOf(millimetres * place->distance_from_mean, 3) +
         " mm away from the posterior mean (root mean square); --mean takes the mean";
}

std::string
scaleNote(Preset preset)
{
  if (preset == Preset::Calibrated)
    return "";
  return std::string("Preset ") + toString(preset) +
         " takes the scale of the standard deviations from the number of effective "
         "points and the sigma in its options. It is not estimated from the clouds; "
         "preset calibrated estimates it.";
}

std::string
statusText(std::string name, const std::string& message)
{
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + ": " + message;
}

std::string
statusText(const Summary& summary)
{
  return statusText(toString(summary.status), summary.message);
}

std::string
matrixText(const Eigen::Matrix4d& matrix)
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
flagNames(const DataFlags& flags)
{
  std::string names;
  for (const DataFlag& flag : data_flags)
    if (flags.*flag.is_raised)
      names += (names.empty() ? "" : ", ") + std::string(flag.key);
  std::replace(names.begin(), names.end(), '_', ' ');
  return names;
}

const char*
holderOf(Observability observability)
{
  return observability == Observability::Observed ? "data"
         : observability == Observability::Weak   ? "weak"
                                                  : "prior";
}

double
angularDeviation(const DataDirection& direction)
{
  const bool is_translation = direction.description.rfind("translation", 0) == 0;
  return is_translation
             ? std::numeric_limits<double>::quiet_NaN()
             : direction.standard_deviation * direction.twist.tail<3>().norm();
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
  text += "\n" + wrapped("Status: " + statusText(summary)) +
          "ICP:    " + icpText(result) + '\n';
  for (const std::string& note :
       {icpNote(run),
        summary.num_draws > 0 ? scaleNote(run.settings.options.preset) : ""})
    if (!note.empty())
      text += wrapped("Note: " + note);
  text += "\nMatrices row by row, for pcl_transform_point_cloud in.pcd out.pcd -matrix "
          "...\n";
  if (summary.num_draws > 0)
    text += "Posterior mean:\n" + matrixText(matrixOf(summary.mean));
  text += std::string("Final transformation (") +
          (result.is_final_the_mean ? "the posterior mean" : "ICP's result") + "):\n" +
          matrixText(result.final_matrix);
  return text;
}

std::string
leftAligned(std::string text, std::size_t width)
{
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string
numberText(double value, int num_decimals, const std::string& unknown)
{
  if (!std::isfinite(value))
    return unknown;
  return std::abs(value) < 1e9 ? io::fixedTextOf(value, num_decimals)
                               : io::textOf(value, 5);
}

std::string
cell(double value, int num_decimals, std::size_t width)
{
  return rightAligned(numberText(value, num_decimals, "-"), width);
}

std::string
wrapped(const std::string& text)
{
  return io::wrapped(text, 88, std::string(8, ' ')) + '\n';
}

} // namespace bayesian_icp::app
