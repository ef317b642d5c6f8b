#include "track/track_report.h"

#include "report/report_html.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace bayesian_icp::app {

namespace {

constexpr double degrees = 57.29577951308232;
/** Of the region that an ellipse shows, in two dimensions: sqrt(-2 log 0.05). */
constexpr double deviations_of_95_percent = 2.447746830680816;
constexpr std::size_t max_ellipses = 40;
constexpr std::size_t max_rows_of_table = 100;

/** Position errors along the axes of scan 0. */
Eigen::Matrix3d
positionCovariance(const GaussianPose& pose)
{
  const Eigen::Matrix3d R = rotationOf(pose.mean);
  return R * pose.covariance.topLeftCorner<3, 3>() * R.transpose();
}

/** The two axes of scan 0 along which the trajectory is longest, in their order. */
std::array<Eigen::Index, 2>
longestAxes(const Track& track)
{
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  for (const GaussianPose& pose : track.poses()) {
    low = low.cwiseMin(pose.mean.head<3>());
    high = high.cwiseMax(pose.mean.head<3>());
  }
  Eigen::Index shortest = 0;
  (high - low).reverse().minCoeff(&shortest);
  shortest = 2 - shortest; // of equal ones z
  return {shortest == 0 ? 1 : 0, shortest == 2 ? 1 : 2};
}

struct Ellipse {
  double x, y, width, height, angle; // [m, degrees]
};

Ellipse
ellipseOf(const GaussianPose& pose, const std::array<Eigen::Index, 2>& axes)
{
  const Eigen::Matrix3d covariance = positionCovariance(pose);
  Eigen::Matrix2d part;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      part(i, j) = covariance(axes[std::size_t(i)], axes[std::size_t(j)]);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(part);
  const Eigen::Vector2d lengths =
      2.0 * deviations_of_95_percent * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Vector2d direction = solver.eigenvectors().col(1);
  return {pose.mean[axes[0]],
          pose.mean[axes[1]],
          lengths[1],
          lengths[0],
          degrees * std::atan2(direction[1], direction[0])};
}

/** By how much ellipses are enlarged: a power of ten that makes the last one at least a
 * fiftieth as wide as the trajectory is long. */
double
enlargement(const Ellipse& last, double extent)
{
  double factor = 1.0;
  while (last.width > 0.0 && factor < 1e6 && factor * last.width < extent / 50.0)
    factor *= 10.0;
  return factor;
}

Chart
pathChart(const Track& track)
{
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  const std::array<Eigen::Index, 2> axes = longestAxes(track);
  const std::vector<GaussianPose>& poses = track.poses();
  std::string path, ellipses;
  double extent = 0.0;
  for (const GaussianPose& pose : poses) {
    path +=
        plotNumber(pose.mean[axes[0]]) + ' ' + plotNumber(pose.mean[axes[1]]) + '\n';
    extent = std::max(extent, pose.mean.head<3>().cwiseAbs().maxCoeff());
  }
  const double factor = enlargement(ellipseOf(poses.back(), axes), extent);
  const std::size_t step = poses.size() / max_ellipses + 1;
  for (std::size_t k = poses.size(); k > 0; k -= std::min(k, step)) {
    const Ellipse ellipse = ellipseOf(poses[k - 1], axes);
    for (const double number : {ellipse.x,
                                ellipse.y,
                                factor * ellipse.width,
                                factor * ellipse.height,
                                ellipse.angle})
      ellipses += plotNumber(number) + ' ';
    ellipses += '\n';
  }
  const std::string x = names[std::size_t(axes[0])], y = names[std::size_t(axes[1])];
  Chart chart;
  chart.id = "path";
  chart.title = "The trajectory";
  chart.caption =
      "Positions in the frame of scan 0, along the two axes along which the "
      "trajectory is longest. Ellipses are 95 % regions" +
      (factor > 1.0 ? ", enlarged " + io::textOf(factor) + " times."
                    : std::string("."));
  chart.description = chart.caption;
  chart.width = html::FigureWidth::Scrolled;
  chart.drawing = {
      720,
      480,
      12,
      plot::dataBlock("path", path) + plot::dataBlock("ellipses", ellipses) +
          chart_style + "set size ratio -1\nset grid linewidth 0.3\nset xlabel '" + x +
          " [m]'\nset ylabel '" + y +
          " [m]'\nplot $ellipses using 1:2:3:4:5 with ellipses linecolor rgb '" +
          chart_colours[1] +
          "', $path using 1:2 with linespoints pointtype 7 "
          "pointsize 0.3 linewidth 1.5 linecolor rgb '" +
          chart_colours[0] + "'\n"};
  return chart;
}

/** A line over time [s]; \p settings are gnuplot's. */
Chart
timeChart(const std::string& id,
          const std::string& caption,
          const std::string& label,
          const std::string& lines,
          const std::string& settings = "")
{
  Chart chart;
  chart.id = id;
  chart.title = chart.caption = chart.description = caption;
  chart.drawing = {
      420,
      240,
      12,
      plot::dataBlock("data", lines) + chart_style +
          "set grid linewidth 0.3\nset xlabel 'time [s]'\nset ylabel " +
          plot::quotedForGnuplot(label) + '\n' + settings +
          "plot $data using 1:2 with linespoints pointtype 7 pointsize 0.3 "
          "linecolor rgb '" +
          chart_colours[0] + "'\n"};
  return chart;
}

std::vector<Chart>
uncertaintyCharts(const Track& track)
{
  std::string positions, rotations, innovations;
  for (std::size_t k = 0; k < track.poses().size(); ++k) {
    const Matrix6d& covariance = track.poses()[k].covariance;
    const std::string time = plotNumber(track.times()[k] - track.times()[0]) + ' ';
    positions +=
        time + plotNumber(std::sqrt(covariance.topLeftCorner<3, 3>().trace())) + '\n';
    rotations +=
        time +
        plotNumber(degrees * std::sqrt(covariance.bottomRightCorner<3, 3>().trace())) +
        '\n';
    if (k == 0)
      continue;
    const int num_measured = 6 - track.steps()[k - 1].edge.num_unmeasured;
    if (num_measured > 0)
      innovations +=
          time + plotNumber(track.innovations()[k - 1] / num_measured) + '\n';
  }
  return {
      timeChart("position",
                "Standard deviation of the position in the frame of scan 0.",
                "position [m]",
                positions),
      timeChart("rotation",
                "Standard deviation of the rotation in the frame of scan 0.",
                "rotation [degrees]",
                rotations),
      timeChart("innovation",
                "Squared difference between prediction and registration, in units of "
                "what both covariances allow. About 1 on average is right; far above "
                "1, --acceleration or --angular-acceleration is too small.",
                "per direction",
                innovations.empty() ? "0 1\n" : innovations,
                "set logscale y\nset arrow from graph 0, first 1 to graph 1, first 1 "
                "nohead dashtype 2\n")};
}

std::array<std::size_t, 4>
countKinds(const Track& track)
{
  std::array<std::size_t, 4> counts{};
  for (const TrackStep& step : track.steps())
    ++counts[static_cast<std::size_t>(step.kind)];
  return counts;
}

std::string
verdictHtml(const Track& track)
{
  const std::array<std::size_t, 4> counts = countKinds(track);
  const std::size_t num_steps = track.steps().size();
  const bool is_good = counts[0] == num_steps;
  std::string sentence = io::textOf(num_steps) + " scans after scan 0";
  for (std::size_t k = 0; k < counts.size(); ++k)
    sentence += (k == 0 ? ": " : ", ") + io::textOf(counts[k]) + ' ' +
                toString(static_cast<StepKind>(k));
  return html::boxHtml(is_good                      ? html::Tone::Good
                       : counts[2] + counts[3] == 0 ? html::Tone::Caution
                                                    : html::Tone::Bad,
                       is_good ? "Every scan is registered"
                               : "Not every scan is registered with status ok",
                       html::paragraphHtml(sentence + '.'));
}

std::string
tableOfProblems(const TrackCommand& command, const Track& track)
{
  html::Table table;
  table.caption = "Scans that are not registered with status ok";
  table.header = {"scan", "file", "target", "became", "status", "message"};
  table.first_column_of_words = 1;
  std::size_t num_left_out = 0;
  for (const TrackStep& step : track.steps()) {
    if (step.kind == StepKind::Registered)
      continue;
    if (table.rows.size() == max_rows_of_table) {
      ++num_left_out;
      continue;
    }
    const std::filesystem::path file =
        command.request.scans.at(static_cast<std::size_t>(step.scan));
    table.rows.push_back({io::textOf(step.scan),
                          file.filename().string(),
                          io::textOf(step.edge.target),
                          toString(step.kind),
                          step.status,
                          step.message});
  }
  if (table.rows.empty())
    return "";
  return html::tableHtml(table) +
         html::paragraphHtml(num_left_out == 0 ? ""
                                               : io::textOf(num_left_out) +
                                                     " more are in edges.jsonl.");
}

} // namespace

std::string
trackReportHtml(const TrackCommand& command, const Track& track)
{
  Section path, uncertainty, repeat;
  path.id = "trajectory";
  path.heading = "Where was the sensor?";
  path.charts = {pathChart(track)};
  path.below_html = tableOfProblems(command, track);
  uncertainty.id = "uncertainty";
  uncertainty.heading = "How sure is that?";
  uncertainty.above_html = html::paragraphHtml(
      "Errors add up along the trajectory. The covariances take the errors of two "
      "registrations as independent, although they have a scan or a map in common.");
  uncertainty.charts = uncertaintyCharts(track);
  repeat.id = "repeat";
  repeat.heading = "To repeat the run";
  repeat.above_html = html::codeHtml(command.command);
  return html::pageHtml("Track of " + io::textOf(track.poses().size()) + " scans",
                        verdictHtml(track) + sectionsHtml({path, uncertainty, repeat}));
}

} // namespace bayesian_icp::app
