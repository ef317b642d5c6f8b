#include "coverage/coverage_setups.h"

#include "io/coordinates.h"
#include "study/axis_deviation.h"
#include "study/named.h"

#include <Eigen/Geometry>

#include <stdexcept>

namespace bayesian_icp::evaluate {

using Eigen::Vector3d;
using simulator::SensorKind;
using simulator::View;

namespace {

/** \brief What a camera's image looks like. */
struct Image {
  int width;
  int height;
  /** Horizontal field of view [rad]. */
  double field_of_view;
};

CoverageSetup
depthCamera(const Image& image, const View& view)
{
  CoverageSetup setup;
  setup.sensor.camera.width = image.width;
  setup.sensor.camera.height = image.height;
  setup.sensor.camera.horizontal_fov = image.field_of_view * app::degrees_per_radian;
  setup.sensor.jitter = 1.0;
  setup.sensor.min_range = 0.2;
  setup.sensor.max_range = 8.0;
  setup.view = view;
  setup.prior_sd = AxisDeviation{0.03, 0.06}.vector();
  return setup;
}

/** \brief A camera with twice the noise, which grows as surfaces turn away. */
CoverageSetup
timeOfFlightCamera(const Image& image, const View& view)
{
  CoverageSetup setup = depthCamera(image, view);
  setup.sensor.noise = 2.0;
  setup.sensor.incidence_noise = 1.0;
  return setup;
}

CoverageSetup
carriedOn(const Vector3d& step, CoverageSetup setup)
{
  setup.step = step;
  return setup;
}

CoverageSetup
lidar(double min_elevation, double max_elevation, const View& view)
{
  CoverageSetup setup;
  setup.sensor.kind = SensorKind::Lidar;
  setup.sensor.lidar.rings = 32;
  setup.sensor.lidar.min_elevation = min_elevation;
  setup.sensor.lidar.max_elevation = max_elevation;
  setup.sensor.lidar.azimuth_step = 0.8;
  setup.sensor.jitter = 1.0;
  setup.sensor.max_range = 12.0;
  setup.view = view;
  setup.step = {0.6, 0.15, 0.1};
  setup.prior_sd = AxisDeviation{0.1, 0.03}.vector();
  return setup;
}

/** \brief The view with an object's origin, the middle of its height, moved to there
 * from its foot. */
View
fromFoot(double height, const View& view)
{
  const Vector3d middle(0.0, 0.0, 0.5 * height);
  return {view.eye - middle, view.look_at - middle};
}

struct NamedSetup {
  std::string name;
  CoverageSetup setup;
};

using Setups = std::vector<NamedSetup>;

const Setups&
tunedSetups()
{
  const Vector3d eye(0.0, -0.8, 0.5);
  const Vector3d object(0.0, 0.0, 0.05);
  const CoverageSetup table = depthCamera({128, 96, 1.0}, {eye, Vector3d::Zero()});
  static const Setups setups = {
      {"bowl", depthCamera({112, 112, 0.36}, fromFoot(0.076, {eye, object}))},
      {"can", depthCamera({112, 112, 0.22}, fromFoot(0.12, {eye, object}))},
      {"mug",
       depthCamera({112, 112, 0.22}, fromFoot(0.10, {{0.25, -0.76, 0.5}, object}))},
      {"table_top", table},
      {"plain_corridor",
       carriedOn({0.6, 0.15, 0.1},
                 depthCamera({128, 96, 1.0}, {{0.0, 0.0, 1.2}, {5.0, 0.1, 1.0}}))},
      {"table", table}};
  return setups;
}

const Setups&
newSetups()
{
  static const Setups setups = {
      {"cube", depthCamera({96, 96, 0.3}, {{0.3, -0.75, 0.5}, {0.0, 0.0, 0.05}})},
      {"bracket", depthCamera({96, 96, 0.22}, {{0.25, -0.7, 0.45}, {0.0, 0.0, 0.03}})},
      {"carton",
       timeOfFlightCamera({96, 96, 0.36}, {{0.3, -0.75, 0.6}, {0.0, 0.0, 0.05}})},
      {"tool", depthCamera({96, 96, 0.26}, {{0.3, -0.65, 0.45}, {0.0, 0.0, 0.02}})},
      {"box",
       timeOfFlightCamera({96, 96, 0.32}, {{0.4, -0.7, 0.45}, {0.0, 0.0, 0.07}})},
      {"stairs",
       carriedOn(
           {0.25, 0.1, 0.05},
           timeOfFlightCamera({96, 96, 0.9}, {{-1.3, 0.0, 1.4}, {0.6, 0.0, 0.4}}))},
      {"room", lidar(-30.0, 10.0, {{0.0, 0.0, 1.2}, {1.0, 0.0, 1.2}})},
      {"car", lidar(-25.0, 0.0, {{-3.5, -3.0, 1.8}, {-2.5, -2.0, 1.8}})},
      {"tree", lidar(-25.0, 15.0, {{-3.0, -1.0, 1.8}, {-2.0, -0.7, 1.8}})},
      {"ground", lidar(-30.0, 0.0, {{0.0, 0.0, 1.8}, {1.0, 0.0, 1.8}})}};
  return setups;
}

CoverageSetup
makeLidarSetup(const std::string& scene)
{
  const simulator::SimulationOptions usual = simulator::defaultOptions(scene);
  CoverageSetup setup;
  setup.sensor = usual.sensor;
  setup.view = usual.target_view;
  setup.prior_sd = AxisDeviation{0.3, 0.03}.vector();
  return setup;
}

/** \throws std::invalid_argument if there is no such scene */
CoverageSetup
findSetup(const std::string& scene)
{
  for (const Setups* setups : {&tunedSetups(), &newSetups()})
    if (const NamedSetup* const found = findNamed(*setups, scene))
      return found->setup;
  if (std::count(lidar_scenes.begin(), lidar_scenes.end(), scene) > 0)
    return makeLidarSetup(scene);
  throw std::invalid_argument("the coverage study has no scene '" + scene + "'");
}

Vector3d
turnedAboutVertical(const Vector3d& vector, double angle)
{
  return Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * vector;
}

} // namespace

std::vector<std::string>
tunedScenes()
{
  return namesOf(tunedSetups());
}

std::vector<std::string>
newScenes()
{
  return namesOf(newSetups());
}

CoverageSetup
coverageSetup(const std::string& scene)
{
  CoverageSetup setup = findSetup(scene);
  // The study's table top has its edges in view.
  setup.simulated_scene = scene == "table_top" ? "table_plate" : scene;
  return setup;
}

View
secondView(const CoverageSetup& setup, double scale, Random& random)
{
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
  const double angle = 0.17 + 0.18 * random.uniform();
  const double rise = 0.08 * (2.0 * random.uniform() - 1.0);
  const Vector3d forward = setup.view.look_at - setup.view.eye;
  if (setup.step.isZero()) {
    const Vector3d turned = turnedAboutVertical(-forward, scale * side * angle);
    return {setup.view.look_at + turned + scale * rise * Vector3d::UnitZ(),
            setup.view.look_at};
  }
  const Vector3d eye = setup.view.eye + scale * setup.step;
  return {eye, eye + turnedAboutVertical(forward, scale * side * 0.2)};
}

DrivenViews
drivenViews(const CoverageSetup& setup, Random& random)
{
  const double start = 8.0 * (2.0 * random.uniform() - 1.0);
  const double heading = 0.05 * (2.0 * random.uniform() - 1.0);
  const double way = 0.5 + 1.5 * random.uniform();
  const double turn = 0.07 * (2.0 * random.uniform() - 1.0);
  const Vector3d forward = setup.view.look_at - setup.view.eye;
  const Vector3d eye = setup.view.eye + start * forward;
  // The chord of an arc points half of its turn aside.
  const Vector3d next = eye + way * turnedAboutVertical(forward, heading + 0.5 * turn);
  return {{eye, eye + turnedAboutVertical(forward, heading)},
          {next, next + turnedAboutVertical(forward, heading + turn)}};
}

} // namespace bayesian_icp::evaluate
