#include "viewer/legend.h"

#include "io/coordinates.h"
#include "io/numbers.h"

#include <cmath>

namespace bayesian_icp::viewer {

namespace {

std::string
pointsText(Eigen::Index num_points)
{
  return " (" + std::to_string(num_points) + " points)";
}

std::string
textOf(const Eigen::Vector3d& values)
{
  return io::textOf(values[0], 3) + ", " + io::textOf(values[1], 3) + ", " +
         io::textOf(values[2], 3);
}

std::string
textOf(Layer layer, const Scene& scene)
{
  const std::optional<Uncertainty>& uncertainty = scene.uncertainty;
  switch (layer) {
  case Layer::Source:
    return "source, at the guess" + pointsText(scene.num_source_points);
  case Layer::Target:
    return "target" + pointsText(scene.num_target_points);
  case Layer::Aligned:
    return "source, aligned";
  case Layer::Deviation:
    return "source at the posterior mean: standard deviation of each point";
  case Layer::Draws:
    return "source at " + std::to_string(uncertainty->shown_draws.size()) + " of " +
           std::to_string(scene.draws.rows()) + " draws";
  default:
    break;
  }
  const double scale = std::sqrt(chi_squared_95_percent_3_dof);
  const PoseSpread& spread = uncertainty->spread;
  return layer == Layer::Position
             ? "position, 95 % (3 dof): ellipsoid of semi-axes " +
                   textOfLengths(scale * spread.positionDeviations())
             : "rotation, 95 % (3 dof): cones of x (red), y (green), z (blue); "
               "semi-axes " +
                   textOfAngles(scale * spread.rotationDeviations());
}

bool
isMagnified(const Panel& panel, const std::optional<Uncertainty>& uncertainty)
{
  return uncertainty && uncertainty->magnification != 1.0 &&
         panel.layers.lower_bound(Layer::Draws) != panel.layers.end();
}

} // namespace

Color
colorOf(Layer layer, const ViewOptions& options)
{
  return layer <= Layer::Aligned ? options.styleOf(layer).color : nameOf(layer).color;
}

Color
textColorOn(const Color& background)
{
  const double lightness =
      0.3 * background[0] + 0.6 * background[1] + 0.1 * background[2];
  return lightness < 0.5 ? Color{1.0, 1.0, 1.0} : Color{0.0, 0.0, 0.0};
}

std::vector<LegendLine>
legendOf(const Panel& panel,
         const Scene& scene,
         const ViewOptions& options,
         bool shows_keys)
{
  const Color plain = textColorOn(options.background);
  std::vector<LegendLine> lines;
  if (!panel.title.empty())
    lines.push_back({panel.title, plain});
  for (const Layer layer : panel.layers) {
    const bool has_own_color = layer != Layer::Deviation && layer != Layer::Rotation;
    const std::string key =
        shows_keys ? std::string("[") + nameOf(layer).key + "] " : "";
    lines.push_back(
        {key + textOf(layer, scene), has_own_color ? colorOf(layer, options) : plain});
  }
  if (isMagnified(panel, scene.uncertainty))
    lines.push_back({"deviations from the mean are drawn " +
                         io::textOf(scene.uncertainty->magnification, 4) +
                         " times as large",
                     plain});
  return lines;
}

std::vector<LegendLine>
statusOf(const Scene& scene, const ViewOptions& options)
{
  const Color color = textColorOn(options.background);
  std::vector<LegendLine> lines = {{scene.status_text, color}};
  if (!scene.note.empty())
    lines.insert(lines.begin(), {scene.note, color});
  return lines;
}

std::vector<LegendLine>
wrapped(const std::vector<LegendLine>& lines, std::size_t width)
{
  std::vector<LegendLine> narrow;
  for (const LegendLine& line : lines) {
    const std::string text = io::wrapped(line.text, width, "    ");
    for (const std::string_view piece : io::splitAt('\n', text))
      narrow.push_back({std::string(piece), line.color});
  }
  return narrow;
}

std::string
textOfLengths(const Eigen::Vector3d& lengths)
{
  const app::LengthUnit unit = app::unitFor(lengths.maxCoeff());
  return textOf(unit.per_metre * lengths) + " " + unit.name;
}

std::string
textOfAngles(const Eigen::Vector3d& angles)
{
  return textOf(app::degrees_per_radian * angles) + " deg";
}

} // namespace bayesian_icp::viewer
