#include "report/charts.h"

#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

#include <algorithm>

namespace bayesian_icp::app {

namespace {

constexpr Eigen::Index max_points = 1800;
constexpr const char* axis_names[] = {"x", "y", "z"};

/** Finite points of a cloud, chosen at random: every k-th point of a scan would be
 * a pattern. */
Eigen::Matrix3Xd
chosenPoints(const io::CloudFile& cloud)
{
  const Eigen::Matrix3Xf points = io::finitePoints(cloud);
  Random random(1, 0);
  const auto chosen = randomChoice(points.cols(), max_points, random);
  return points(Eigen::all, chosen).cast<double>();
}

/** Both clouds in the target frame. */
struct Scene {
  Eigen::Matrix3Xd target;
  Eigen::Matrix3Xd source;
};

/** What is seen of an axis [m]. */
struct Range {
  double low = 0.0;
  double high = 1.0;

  double
  span() const
  {
    return high - low;
  }
};

/** All but a few stray points, with a margin. */
Range
rangeOf(const Scene& scene, Eigen::Index axis)
{
  constexpr double stray = 0.005, margin = 0.06;
  Eigen::VectorXd values(scene.target.cols() + scene.source.cols());
  values << scene.target.row(axis).transpose(), scene.source.row(axis).transpose();
  const double low = quantile(values, stray), high = quantile(values, 1.0 - stray);
  const double added = margin * (high - low) + 1e-6;
  return {low - added, high + added};
}

/** What is subtracted from coordinates that are much larger than their range: a round
 * number [m]. */
double
originOf(const Range& range)
{
  constexpr double min_ratio = 100.0;
  const double unit = std::pow(10.0, std::ceil(std::log10(range.span())));
  const double origin = unit * std::round(0.5 * (range.low + range.high) / unit);
  return std::abs(origin) > min_ratio * range.span() ? origin : 0.0;
}

/** As "x [m]" or "x - 5412340 [m]". */
std::string
axisLabel(Eigen::Index axis, double origin)
{
  constexpr int num_digits = 12;
  std::string label = axis_names[axis];
  if (origin != 0.0)
    label += (origin > 0.0 ? " - " : " + ") + io::textOf(std::abs(origin), num_digits);
  return label + " [m]";
}

Range
widened(const Range& range, double span)
{
  const double added = 0.5 * std::max(0.0, span - range.span());
  return {range.low - added, range.high + added};
}

/** A picture's layout in pixels: the plot in it and its margins. */
constexpr double plot_width = 350.0, max_plot_height = 350.0, min_plot_height = 130.0;
constexpr double left_margin = 66.0, right_margin = 12.0;
constexpr double bottom_margin = 50.0, top_margin = 8.0;

std::string
pointsBlock(const std::string& name,
            const Eigen::Matrix3Xd& points,
            const Eigen::Vector3d& origin)
{
  std::string lines;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    lines += plotLine(Eigen::Vector3d(points.col(i) - origin));
  return plot::dataBlock(name, lines);
}

/** One metre is as long on both axes: the picture's height is made to fit, or else what
 * is seen of one axis is widened. */
plot::Drawing
viewOf(const Scene& scene, Eigen::Index horizontal, Eigen::Index vertical)
{
  Range x = rangeOf(scene, horizontal), y = rangeOf(scene, vertical);
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  origin[horizontal] = originOf(x);
  origin[vertical] = originOf(y);
  x = {x.low - origin[horizontal], x.high - origin[horizontal]};
  y = {y.low - origin[vertical], y.high - origin[vertical]};
  const double plot_height =
      std::clamp(plot_width * y.span() / x.span(), min_plot_height, max_plot_height);
  x = widened(x, y.span() * plot_width / plot_height);
  y = widened(y, x.span() * plot_height / plot_width);
  const double width = plot_width + left_margin + right_margin;
  const double height = plot_height + bottom_margin + top_margin;
  const std::string columns =
      " using " + std::to_string(horizontal + 1) + ':' + std::to_string(vertical + 1);
  return {static_cast<int>(width),
          static_cast<int>(height),
          pointsBlock("target", scene.target, origin) +
              pointsBlock("source", scene.source, origin) + chart_style +
              placedAt(left_margin / width,
                       1.0 - right_margin / width,
                       bottom_margin / height,
                       1.0 - top_margin / height) +
              "set border 15\nset xrange " + plotRange(x.low, x.high) +
              "\nset yrange " + plotRange(y.low, y.high) + "\nset xlabel '" +
              axisLabel(horizontal, origin[horizontal]) + "' offset 0, 0.4\n" +
              labelledAtLeft(axisLabel(vertical, origin[vertical])) + "plot " +
              dots("$target" + columns, x.span(), 2.0, target_colour) + ", " +
              dots("$source" + columns, x.span(), 2.0, source_colour) + '\n'};
}

/** From above and from the side that shows more. */
std::vector<Chart>
viewsOf(const Scene& scene, const std::string& when)
{
  const auto chartOf = [&](const char* view, const std::string& words, auto... axes) {
    const std::string title = "Clouds " + when + ", " + words;
    return Chart{
        "clouds-" + when + '-' + view,
        title,
        title + '.',
        "Points of the target in blue and of the source in orange, in metres of "
        "the target frame, " +
            when + ", " + words + '.',
        viewOf(scene, axes...)};
  };
  const Eigen::Index wide =
      rangeOf(scene, 0).span() >= rangeOf(scene, 1).span() ? 0 : 1;
  return {
      chartOf("above", "from above (x, y)", 0, 1),
      chartOf(
          "side", std::string("from the side (") + axis_names[wide] + ", z)", wide, 2)};
}

} // namespace

std::vector<Chart>
cloudCharts(const Run& run)
{
  const Eigen::Matrix3Xd target = chosenPoints(run.target);
  const Eigen::Matrix3Xd source = chosenPoints(run.source);
  std::vector<Chart> charts =
      viewsOf({target, Eigen::Affine3d(run.settings.guess) * source}, "before");
  for (Chart& chart :
       viewsOf({target, Eigen::Affine3d(run.result.final_matrix) * source}, "after"))
    charts.push_back(std::move(chart));
  return charts;
}

} // namespace bayesian_icp::app
