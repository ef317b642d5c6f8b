#include "viewer/drawing.h"

#include "io/picture_numbers.h"

#include <pcl/common/colors.h>
#include <pcl/visualization/pcl_visualizer.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <vtkActor.h>
#include <vtkProperty.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
namespace visualization = pcl::visualization;

/** As light as a few scans, and not so dense that nothing else is seen. */
constexpr Eigen::Index max_points_of_draws = 15000;

Cloud::Ptr
cloudOf(const Eigen::Matrix3Xd& points)
{
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3f point = points.col(i).cast<float>();
    cloud->push_back({point.x(), point.y(), point.z()});
  }
  return cloud;
}

void
setSizeAndOpacity(
    int size, double opacity, const std::string& id, int viewport, Window& window)
{
  auto& visualizer = window.visualizer();
  visualizer.setPointCloudRenderingProperties(
      visualization::PCL_VISUALIZER_POINT_SIZE, size, id, viewport);
  visualizer.setPointCloudRenderingProperties(
      visualization::PCL_VISUALIZER_OPACITY, opacity, id, viewport);
}

/** Draws the layers of one panel. */
struct PanelDrawing {
  const Scene& scene;
  const ViewOptions& options;
  int viewport;
  Window& window;

  void
  draw(Layer layer)
  {
    const std::string id =
        std::string(nameOf(layer).name) + "/" + std::to_string(viewport);
    const auto add = [&](const Eigen::Matrix3Xd& points, const PointStyle& style) {
      addPoints(points, style, id, viewport, window);
    };
    switch (layer) {
    case Layer::Source:
      return add(Eigen::Affine3d(scene.guess) * scene.source, options.styleOf(layer));
    case Layer::Target:
      return add(scene.target, options.styleOf(layer));
    case Layer::Aligned:
      return add(Eigen::Affine3d(scene.final_matrix) * scene.source,
                 options.styleOf(layer));
    case Layer::Deviation:
      return addDeviations(id);
    case Layer::Draws:
      return add(pointsAtDraws(scene, max_points_of_draws),
                 {colorOf(layer, options), 2, 0.35});
    case Layer::Position:
      return addEllipsoid(id);
    case Layer::Rotation:
      return addCones(id);
    }
  }

  void
  addDeviations(const std::string& id)
  {
    const Uncertainty& uncertainty = *scene.uncertainty;
    const Eigen::Matrix3Xf points =
        (Eigen::Affine3d(uncertainty.spread.meanMatrix()) * scene.source).cast<float>();
    const double maximum = io::roundedUp(uncertainty.point_deviations.maxCoeff());
    pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZRGB>);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double share = uncertainty.point_deviations[i] / maximum;
      const pcl::RGB color =
          pcl::ViridisLUT::at(std::lround(255.0 * std::min(share, 1.0)));
      cloud->push_back(
          {points(0, i), points(1, i), points(2, i), color.r, color.g, color.b});
    }
    window.visualizer().addPointCloud<pcl::PointXYZRGB>(cloud, id, viewport);
    const PointStyle& style = options.styleOf(Layer::Aligned);
    setSizeAndOpacity(style.size + 1, style.opacity, id, viewport, window);
    window.addColorBar(maximum, textColorOn(options.background), viewport);
  }

  void
  addEllipsoid(const std::string& id)
  {
    const Eigen::Affine3d ball = positionEllipsoid(scene);
    auto& visualizer = window.visualizer();
    visualizer.addEllipsoid(
        Eigen::Isometry3d(ball.matrix()), 1.0, 1.0, 1.0, id, viewport);
    // PCL's way to set the colour of a shape would take its shading away.
    vtkProperty& look =
        *vtkActor::SafeDownCast((*visualizer.getShapeActorMap())[id])->GetProperty();
    const auto [red, green, blue] = colorOf(Layer::Position, options);
    look.SetColor(red, green, blue);
    look.SetOpacity(0.7);
  }

  void
  addCones(const std::string& id)
  {
    auto& visualizer = window.visualizer();
    const std::array<Eigen::Matrix3Xd, 3> cones = rotationCones(scene);
    const Color text_color = textColorOn(options.background);
    for (std::size_t k = 0; k < 3; ++k) {
      Color color = {0.15, 0.15, 0.15};
      color[k] = 0.9;
      const std::string name = id + "/" + std::to_string(k);
      const auto last = static_cast<int>(cones[k].cols()) - 1;
      std::vector<pcl::Vertices> triangles(last);
      for (int i = 1; i <= last; ++i)
        triangles[i - 1].vertices = {0, i, i % last + 1};
      visualizer.addPolygonMesh<pcl::PointXYZ>(
          cloudOf(cones[k]), triangles, name, viewport);
      visualizer.setPointCloudRenderingProperties(visualization::PCL_VISUALIZER_COLOR,
                                                  color[0],
                                                  color[1],
                                                  color[2],
                                                  name,
                                                  viewport);
      visualizer.setPointCloudRenderingProperties(
          visualization::PCL_VISUALIZER_OPACITY, 0.6, name, viewport);
      // A quarter round the rim, which is the middle of a fan.
      window.addAxisName(k, cones[k].col(1 + last / 4), text_color, name, viewport);
    }
  }
};

/** Axes of the target frame. PCL's own are drawn by what VTK 9 warns of at length. */
void
addAxes(double scale, const Color& text_color, int viewport, Window& window)
{
  auto& visualizer = window.visualizer();
  for (std::size_t k = 0; k < 3; ++k) {
    Color color = {0.0, 0.0, 0.0};
    color[k] = 1.0;
    pcl::PointXYZ end(0.0F, 0.0F, 0.0F);
    end.data[k] = static_cast<float>(scale);
    const std::string id = "axes/" + std::to_string(viewport) + "/" + std::to_string(k);
    visualizer.addLine(pcl::PointXYZ(0.0F, 0.0F, 0.0F),
                       end,
                       color[0],
                       color[1],
                       color[2],
                       id,
                       viewport);
    visualizer.setShapeRenderingProperties(
        visualization::PCL_VISUALIZER_LINE_WIDTH, 4, id, viewport);
    window.addAxisName(k, scale * Eigen::Vector3d::Unit(k), text_color, id, viewport);
  }
}

} // namespace

void
addPoints(const Eigen::Matrix3Xd& points,
          const PointStyle& style,
          const std::string& id,
          int viewport,
          Window& window)
{
  auto& visualizer = window.visualizer();
  visualizer.addPointCloud<pcl::PointXYZ>(cloudOf(points), id, viewport);
  const auto [red, green, blue] = style.color;
  visualizer.setPointCloudRenderingProperties(
      visualization::PCL_VISUALIZER_COLOR, red, green, blue, id, viewport);
  setSizeAndOpacity(style.size, style.opacity, id, viewport, window);
}

void
drawScene(const Scene& scene, const ViewOptions& options, Window& window)
{
  const std::vector<Panel> panels = options.panels(scene.uncertainty.has_value());
  const std::vector<int> viewports = window.makePanels(panels.size());
  const auto wrappedIn = [&window](const Layers& layers,
                                   const std::vector<LegendLine>& lines) {
    return wrapped(lines, window.lineWidth(layers.count(Layer::Deviation) > 0));
  };
  const auto status = wrappedIn(panels.front().layers, statusOf(scene, options));
  Layers shown;
  std::size_t num_lines = 0;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const auto& [title, layers] = panels[i];
    PanelDrawing drawing{scene, options, viewports[i], window};
    for (const Layer layer : layers)
      drawing.draw(layer);
    shown.insert(layers.begin(), layers.end());
    if (options.axes_scale > 0.0)
      addAxes(
          options.axes_scale, textColorOn(options.background), viewports[i], window);
    auto lines =
        wrappedIn(layers, legendOf(panels[i], scene, options, !options.isOffScreen()));
    if (!window.hasRoomFor(lines.size() + status.size()))
      lines.resize(title.empty() ? 0 : 1);
    num_lines = std::max(num_lines, lines.size());
    window.addLegend(lines, viewports[i]);
  }
  window.addStatus(status, viewports.front());
  window.lookAt(
      shownPoints(scene, shown),
      defaultView(scene.target, scene.sensor_origin),
      window.areaBeside(num_lines, status.size(), shown.count(Layer::Deviation) > 0));
}

} // namespace bayesian_icp::viewer
