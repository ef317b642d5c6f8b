#include "report/path_charts.h"

#include "io/coordinates.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace bayesian_icp::app {

namespace {

/** Of the region that an ellipse shows, in two dimensions: sqrt(-2 log 0.05). */
constexpr double deviations_of_95_percent = 2.447746830680816;
constexpr std::size_t max_ellipses = 40;

using Axes = std::array<Eigen::Index, 2>;

/** Position errors along the axes of scan 0. */
Eigen::Matrix3d
positionCovariance(const GaussianPose& pose)
{
  const Eigen::Matrix3d R = rotationOf(pose.mean);
  return R * pose.covariance.topLeftCorner<3, 3>() * R.transpose();
}

/** The two axes of scan 0 along which the trajectory is longest, in their order. A
 * straight one is shown from above: the noise of its other axes says nothing. */
Axes
longestAxes(const std::vector<GaussianPose>& poses)
{
  constexpr double min_share = 0.02;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  for (const GaussianPose& pose : poses) {
    low = low.cwiseMin(pose.mean.head<3>());
    high = high.cwiseMax(pose.mean.head<3>());
  }
  Eigen::Array3d lengths = high - low;
  lengths = (lengths < min_share * lengths.maxCoeff()).select(0.0, lengths);
  Eigen::Index shortest = 0;
  lengths.reverse().minCoeff(&shortest);
  shortest = 2 - shortest; // of equal ones z
  return {shortest == 0 ? 1 : 0, shortest == 2 ? 1 : 2};
}

struct Ellipse {
  double x, y, width, height, angle; // [m, degrees]
};

Ellipse
ellipseOf(const GaussianPose& pose, const Axes& axes)
{
  const Eigen::Matrix2d part = positionCovariance(pose)(axes, axes);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(part);
  const Eigen::Vector2d lengths =
      2.0 * deviations_of_95_percent * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Vector2d direction = solver.eigenvectors().col(1);
  return {pose.mean[axes[0]],
          pose.mean[axes[1]],
          lengths[1],
          lengths[0],
          degrees_per_radian * std::atan2(direction[1], direction[0])};
}

/** By how much ellipses are enlarged: a power of ten that makes the largest one at
 * least a fiftieth as wide as the trajectory is long. */
double
enlargement(double width, double extent)
{
  double factor = 1.0;
  while (width > 0.0 && factor < 1e6 && factor * width < extent / 50.0)
    factor *= 10.0;
  return factor;
}

/** The ellipses as gnuplot reads them. \param[out] factor by which they are enlarged */
std::string
ellipseLines(const std::vector<GaussianPose>& poses, const Axes& axes, double& factor)
{
  std::vector<Ellipse> ellipses;
  double extent = 0.0, width = 0.0;
  for (const GaussianPose& pose : poses)
    extent = std::max(extent, pose.mean.head<3>().cwiseAbs().maxCoeff());
  const std::size_t step = poses.size() / max_ellipses + 1;
  for (std::size_t k = poses.size(); k > 0; k -= std::min(k, step)) {
    ellipses.push_back(ellipseOf(poses[k - 1], axes));
    width = std::max(width, ellipses.back().width);
  }
  factor = enlargement(width, extent);
  std::string lines;
  for (const Ellipse& ellipse : ellipses) {
    // gnuplot has a size of its own for ellipses without one.
    const double x = ellipse.width > 0.0 ? ellipse.x : std::nan("");
    lines += plotLine(
        {x, ellipse.y, factor * ellipse.width, factor * ellipse.height, ellipse.angle});
  }
  return lines;
}

std::string
pointLine(const GaussianPose& pose, const Axes& axes)
{
  return plotLine({pose.mean[axes[0]], pose.mean[axes[1]]});
}

std::string
pathLines(const std::vector<GaussianPose>& poses, const Axes& axes)
{
  std::string lines;
  for (const GaussianPose& pose : poses)
    lines += pointLine(pose, axes);
  return lines;
}

std::string
lineStyle(double width, const char* colour)
{
  return " with lines linewidth " + plotNumber(width) + colouredAs(colour);
}

std::string
pathScript(const PathData& path, const Axes& axes, const std::string& ellipses)
{
  std::string loops;
  for (const auto& [first, second] : path.loops)
    for (const int k : {first, second})
      loops +=
          pointLine(path.poses.at(std::size_t(k)), axes) + (k == second ? "\n" : "");
  std::string blocks = plot::dataBlock("path", pathLines(path.poses, axes)) +
                       plot::dataBlock("ellipses", ellipses);
  std::string plots =
      "plot $ellipses using 1:2:3:4:5 with ellipses" + colouredAs(ellipse_colour);
  if (!path.before.empty()) {
    blocks += plot::dataBlock("before", pathLines(path.before, axes));
    plots += ", $before using 1:2" + lineStyle(1.0, before_colour) + " dashtype 2";
  }
  if (!path.loops.empty()) {
    blocks += plot::dataBlock("loops", loops);
    plots += ", $loops using 1:2" + lineStyle(1.5, loop_colour);
  }
  return blocks + chart_style + "set size ratio -1\nset grid linewidth 0.3\n" +
         "set xlabel '" + "xyz"[axes[0]] + " [m]'\nset ylabel '" + "xyz"[axes[1]] +
         " [m]'\n" + plots +
         ", $path using 1:2 with linespoints pointtype 7 pointsize 0.3 linewidth 1.5" +
         colouredAs(path_colour) + '\n';
}

constexpr int width = 720;

/** Of the picture: a metre is as long on both axes. */
int
heightFor(const std::vector<GaussianPose>& poses, const Axes& axes)
{
  constexpr double margins = 80.0, least = 200.0, most = 480.0;
  Eigen::Array2d low = poses.front().mean(axes).array(), high = low;
  for (const GaussianPose& pose : poses) {
    low = low.min(pose.mean(axes).array());
    high = high.max(pose.mean(axes).array());
  }
  const Eigen::Array2d span = high - low;
  const double ratio = span[0] > 0.0 ? span[1] / span[0] : 1.0;
  return static_cast<int>(std::clamp(margins + width * ratio, least, most));
}

/** A line of each pose: x and what \p deviationOf says of its covariance. */
template <typename DeviationOf>
std::string
deviationLines(const std::vector<double>& x,
               const std::vector<GaussianPose>& poses,
               const DeviationOf& deviationOf)
{
  std::string lines;
  for (std::size_t k = 0; k < poses.size(); ++k)
    lines += plotLine({x.at(k), deviationOf(poses[k].covariance)});
  return lines;
}

} // namespace

Chart
pathChart(const PathData& path)
{
  const Axes axes = longestAxes(path.poses);
  double factor = 1.0;
  const std::string ellipses = ellipseLines(path.poses, axes, factor);
  const std::string caption =
      "Positions in the frame of scan 0, along the two axes along which the trajectory "
      "is longest. Ellipses are 95 % regions" +
      (factor > 1.0 ? ", enlarged " + io::textOf(factor) + " times." : ".");
  return {"path",
          "The trajectory",
          caption,
          caption,
          {width, heightFor(path.poses, axes), pathScript(path, axes, ellipses)},
          html::FigureWidth::Scrolled};
}

std::vector<Chart>
deviationCharts(const std::vector<double>& x,
                const std::string& x_label,
                const PathData& path)
{
  const auto of_position = [](const Matrix6d& covariance) {
    return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  };
  const auto of_rotation = [](const Matrix6d& covariance) {
    return degrees_per_radian * std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  };
  const auto chartOf = [&](const std::string& name,
                           const std::string& unit,
                           const auto& deviationOf) {
    std::string script =
        plot::dataBlock("data", deviationLines(x, path.poses, deviationOf));
    std::string plots = "plot $data using 1:2" + lineStyle(1.5, path_colour);
    if (!path.before.empty()) {
      script += plot::dataBlock("before", deviationLines(x, path.before, deviationOf));
      plots += ", $before using 1:2" + lineStyle(1.0, before_colour) + " dashtype 2";
    }
    return lineChart(name,
                     "Standard deviation of the " + name + " in the frame of scan 0.",
                     x_label,
                     name + " [" + unit + ']',
                     script + plots + '\n');
  };
  return {chartOf("position", "m", of_position),
          chartOf("rotation", "degrees", of_rotation)};
}

Chart
lineChart(const std::string& id,
          const std::string& caption,
          const std::string& x_label,
          const std::string& y_label,
          const std::string& script)
{
  return {id,
          caption,
          caption,
          caption,
          {420,
           240,
           chart_style + std::string("set grid linewidth 0.3\nset xlabel ") +
               plot::quotedForGnuplot(x_label) + "\nset ylabel " +
               plot::quotedForGnuplot(y_label) + '\n' + script}};
}

} // namespace bayesian_icp::app
