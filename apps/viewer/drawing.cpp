#include "viewer/drawing.h"

#include "viewer/annotations.h"

#include <pcl/visualization/pcl_visualizer.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

/** As light as a few scans, and not so dense that nothing else is seen. */
constexpr Eigen::Index max_points_of_draws = 15000;

pcl::PointXYZRGB
pointOf(const Eigen::Vector3d& position, const Color& color)
{
  const auto byte = [](double part) {
    return static_cast<std::uint8_t>(std::lround(255.0 * part));
  };
  const Eigen::Vector3f p = position.cast<float>();
  pcl::PointXYZRGB point(byte(color[0]), byte(color[1]), byte(color[2]));
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

/** \p colors is one for all or one for each. */
Cloud::Ptr
cloudOf(const Eigen::Matrix3Xd& points, const std::vector<Color>& colors)
{
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud->push_back(pointOf(
        points.col(i), colors[colors.size() == 1 ? 0 : static_cast<std::size_t>(i)]));
  return cloud;
}

void
addCloud(const Cloud::Ptr& cloud,
         int point_size,
         double opacity,
         const std::string& id,
         int viewport,
         Window& window)
{
  auto& visualizer = window.visualizer();
  visualizer.addPointCloud<pcl::PointXYZRGB>(cloud, id, viewport);
  visualizer.setPointCloudRenderingProperties(
      pcl::visualization::PCL_VISUALIZER_POINT_SIZE, point_size, id, viewport);
  visualizer.setPointCloudRenderingProperties(
      pcl::visualization::PCL_VISUALIZER_OPACITY, opacity, id, viewport);
}

/** Draws the layers of one panel. */
class PanelDrawing {
public:
  PanelDrawing(const Scene& scene,
               const ViewOptions& options,
               int viewport,
               Window& window)
  : scene_(scene)
  , options_(options)
  , viewport_(viewport)
  , window_(window)
  {}

  void
  draw(Layer layer)
  {
    const std::string id =
        std::string(nameOf(layer).name) + "/" + std::to_string(viewport_);
    const auto add = [&](const Eigen::Matrix3Xd& points, const PointStyle& style) {
      addPoints(points, style, id, viewport_, window_);
    };
    const Eigen::Matrix4d identity = Eigen::Matrix4d::Identity();
    switch (layer) {
    case Layer::Source:
      return add(movedPoints(scene_.guess, scene_.source), styleOf(layer, options_));
    case Layer::Target:
      return add(movedPoints(identity, scene_.target), styleOf(layer, options_));
    case Layer::Aligned:
      return add(movedPoints(scene_.final_matrix, scene_.source),
                 styleOf(layer, options_));
    case Layer::Deviation:
      return addDeviations(id);
    case Layer::Draws:
      return add(pointsAtDraws(scene_, max_points_of_draws),
                 {colorOf(layer, options_), 2, 0.35});
    case Layer::Position:
      return addMesh(positionEllipsoid(scene_), colorOf(layer, options_), 0.7, id);
    case Layer::Rotation:
      return addCones(id);
    }
  }

private:
  void
  addDeviations(const std::string& id)
  {
    const Uncertainty& uncertainty = *scene_.uncertainty;
    const double maximum = niceMaximum(uncertainty.largest_point_deviation);
    std::vector<Color> colors;
    for (const double deviation : uncertainty.point_deviations)
      if (std::isfinite(deviation))
        colors.push_back(mapColor(deviation / maximum));
    const PointStyle style = styleOf(Layer::Aligned, options_);
    addCloud(
        cloudOf(movedPoints(uncertainty.spread.meanMatrix(), scene_.source), colors),
        style.size + 1,
        style.opacity,
        id,
        viewport_,
        window_);
    addColorBar(maximum, textColorOn(options_.background), viewport_, window_);
  }

  void
  addCones(const std::string& id)
  {
    const std::array<Mesh, 3> cones = rotationCones(scene_);
    for (std::size_t k = 0; k < 3; ++k) {
      Color color = {0.15, 0.15, 0.15};
      color[k] = 0.9;
      addMesh(cones[k], color, 0.6, id + "/" + std::to_string(k));
    }
  }

  void
  addMesh(const Mesh& mesh, const Color& color, double opacity, const std::string& id)
  {
    std::vector<pcl::Vertices> triangles(mesh.triangles.cols());
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i)
      for (int k = 0; k < 3; ++k)
        triangles[i].vertices.push_back(mesh.triangles(k, i));
    auto& visualizer = window_.visualizer();
    visualizer.addPolygonMesh<pcl::PointXYZRGB>(
        cloudOf(mesh.vertices, {color}), triangles, id, viewport_);
    visualizer.setPointCloudRenderingProperties(
        pcl::visualization::PCL_VISUALIZER_OPACITY, opacity, id, viewport_);
  }

  const Scene& scene_;
  const ViewOptions& options_;
  int viewport_;
  Window& window_;
};

/** Axes of the target frame. PCL's own are drawn by what VTK 9 warns of at length. */
void
addAxes(double scale, Window& window)
{
  auto& visualizer = window.visualizer();
  for (std::size_t k = 0; k < 3; ++k) {
    Color color = {0.0, 0.0, 0.0};
    color[k] = 1.0;
    const Eigen::Vector3d end =
        scale * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k));
    const std::string id = "axes/" + std::to_string(k);
    visualizer.addLine(pointOf(Eigen::Vector3d::Zero(), color),
                       pointOf(end, color),
                       color[0],
                       color[1],
                       color[2],
                       id);
    visualizer.setShapeRenderingProperties(
        pcl::visualization::PCL_VISUALIZER_LINE_WIDTH, 4, id);
  }
}

} // namespace

PointStyle
styleOf(Layer layer, const ViewOptions& options)
{
  const auto index = static_cast<std::size_t>(layer);
  PointStyle style{colorOf(layer, options), layer == Layer::Target ? 2 : 3, 1.0};
  if (index < options.point_sizes.size())
    style.size = options.point_sizes[index];
  if (index < options.opacities.size())
    style.opacity = options.opacities[index];
  return style;
}

void
addPoints(const Eigen::Matrix3Xd& points,
          const PointStyle& style,
          const std::string& id,
          int viewport,
          Window& window)
{
  addCloud(
      cloudOf(points, {style.color}), style.size, style.opacity, id, viewport, window);
}

void
drawScene(const Scene& scene, const ViewOptions& options, Window& window)
{
  const std::vector<Panel> panels = options.panels(scene.uncertainty.has_value());
  const std::vector<int> viewports = window.makePanels(panels.size());
  Layers shown;
  std::size_t num_lines = 0;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    PanelDrawing drawing(scene, options, viewports[i], window);
    for (const Layer layer : panels[i].layers)
      drawing.draw(layer);
    shown.insert(panels[i].layers.begin(), panels[i].layers.end());
    const auto lines = legendOf(panels[i], scene, options, !options.isOffScreen());
    num_lines = std::max(num_lines, lines.size());
    addLegend(lines, viewports[i], window);
  }
  if (options.axes_scale > 0.0)
    addAxes(options.axes_scale, window);
  addStatus(
      {scene.status + ": " + scene.status_message, textColorOn(options.background)},
      viewports.front(),
      window);
  const Eigen::Matrix3Xd target =
      movedPoints(Eigen::Matrix4d::Identity(), scene.target);
  window.lookAt(shownPoints(scene, shown),
                defaultView(target, scene.sensor_origin),
                areaBeside(num_lines, shown.count(Layer::Deviation) > 0, window));
}

} // namespace bayesian_icp::viewer
