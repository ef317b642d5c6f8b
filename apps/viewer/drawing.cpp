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

/** One layer of one panel. */
class LayerDrawing {
public:
  /** \p uncertainty may be null if no layer is drawn that needs draws. */
  LayerDrawing(const Scene& scene,
               const Uncertainty* uncertainty,
               const ViewOptions& options,
               int viewport,
               Window& window)
  : scene_(scene)
  , uncertainty_(uncertainty)
  , options_(options)
  , viewport_(viewport)
  , window_(window)
  {}

  void
  draw(Layer layer)
  {
    const Eigen::Matrix4d identity = Eigen::Matrix4d::Identity();
    switch (layer) {
    case Layer::Source:
      return addCloud(layer, movedPoints(scene_.guess, scene_.source));
    case Layer::Target:
      return addCloud(layer, movedPoints(identity, scene_.target));
    case Layer::Aligned:
      return addCloud(layer, movedPoints(scene_.final_matrix, scene_.source));
    case Layer::Deviation:
      return addDeviations();
    case Layer::Draws:
      return addDraws();
    case Layer::Position:
      return addEllipsoid();
    case Layer::Rotation:
      return addCones();
    }
  }

private:
  std::string
  idOf(Layer layer) const
  {
    return std::string(nameOf(layer).name) + "/" + std::to_string(viewport_);
  }

  void
  addCloud(Layer layer, const Eigen::Matrix3Xd& points)
  {
    addPoints(points, styleOf(layer, options_), idOf(layer), viewport_, window_);
  }

  void
  addDeviations()
  {
    const double maximum = niceMaximum(uncertainty_->largest_point_deviation);
    const Eigen::Matrix3Xd points =
        movedPoints(uncertainty_->spread.meanMatrix(), scene_.source);
    Cloud::Ptr cloud(new Cloud);
    Eigen::Index num_finite = 0;
    for (const double deviation : uncertainty_->point_deviations)
      if (std::isfinite(deviation))
        cloud->push_back(
            pointOf(points.col(num_finite++), mapColor(deviation / maximum)));
    const std::string id = idOf(Layer::Deviation);
    auto& visualizer = window_.visualizer();
    visualizer.addPointCloud<pcl::PointXYZRGB>(cloud, id, viewport_);
    const PointStyle style = styleOf(Layer::Aligned, options_);
    visualizer.setPointCloudRenderingProperties(
        pcl::visualization::PCL_VISUALIZER_POINT_SIZE, style.size + 1, id, viewport_);
    visualizer.setPointCloudRenderingProperties(
        pcl::visualization::PCL_VISUALIZER_OPACITY, style.opacity, id, viewport_);
    addColorBar(maximum, textColorOn(options_.background), viewport_, window_);
  }

  void
  addDraws()
  {
    addPoints(pointsAtDraws(scene_, *uncertainty_, max_points_of_draws),
              {colorOf(Layer::Draws, options_), 2, 0.35},
              idOf(Layer::Draws),
              viewport_,
              window_);
  }

  void
  addEllipsoid()
  {
    addMesh(positionEllipsoid(*uncertainty_),
            {colorOf(Layer::Position, options_), 1, 0.7},
            idOf(Layer::Position));
  }

  void
  addCones()
  {
    const std::array<Mesh, 3> cones = rotationCones(scene_, *uncertainty_);
    for (std::size_t k = 0; k < 3; ++k) {
      Color color = {0.15, 0.15, 0.15};
      color[k] = 0.9;
      addMesh(
          cones[k], {color, 1, 0.6}, idOf(Layer::Rotation) + "/" + std::to_string(k));
    }
  }

  void
  addMesh(const Mesh& mesh, const PointStyle& style, const std::string& id)
  {
    Cloud::Ptr vertices(new Cloud);
    for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
      vertices->push_back(pointOf(mesh.vertices.col(i), style.color));
    std::vector<pcl::Vertices> triangles(mesh.triangles.cols());
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i)
      for (int k = 0; k < 3; ++k)
        triangles[i].vertices.push_back(mesh.triangles(k, i));
    auto& visualizer = window_.visualizer();
    visualizer.addPolygonMesh<pcl::PointXYZRGB>(vertices, triangles, id, viewport_);
    visualizer.setPointCloudRenderingProperties(
        pcl::visualization::PCL_VISUALIZER_OPACITY, style.opacity, id, viewport_);
  }

  const Scene& scene_;
  const Uncertainty* uncertainty_;
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
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud->push_back(pointOf(points.col(i), style.color));
  auto& visualizer = window.visualizer();
  visualizer.addPointCloud<pcl::PointXYZRGB>(cloud, id, viewport);
  visualizer.setPointCloudRenderingProperties(
      pcl::visualization::PCL_VISUALIZER_POINT_SIZE, style.size, id, viewport);
  visualizer.setPointCloudRenderingProperties(
      pcl::visualization::PCL_VISUALIZER_OPACITY, style.opacity, id, viewport);
}

void
drawScene(const Scene& scene,
          const Uncertainty* uncertainty,
          const ViewOptions& options,
          Window& window)
{
  const std::vector<Panel> panels = options.panels(uncertainty != nullptr);
  const std::vector<int> viewports = window.makePanels(panels.size());
  Layers shown;
  std::size_t num_lines = 0;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    LayerDrawing drawing(scene, uncertainty, options, viewports[i], window);
    for (const Layer layer : panels[i].layers)
      drawing.draw(layer);
    shown.insert(panels[i].layers.begin(), panels[i].layers.end());
    const auto lines =
        legendOf(panels[i], scene, uncertainty, options, !options.isOffScreen());
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
  window.lookAt(shownPoints(scene, uncertainty, shown),
                defaultView(target, scene.sensor_origin),
                areaBeside(num_lines, shown.count(Layer::Deviation) > 0, window));
}

} // namespace bayesian_icp::viewer
