#include "simulator/beams.h"

#include "simulator/rays.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double radians_per_degree = pi / 180.0;

Vector3d
cameraDirection(const DepthCameraOptions& camera, double x, double y)
{
  const double focal_length =
      0.5 * camera.width / std::tan(0.5 * camera.horizontal_fov * radians_per_degree);
  return Vector3d((x - 0.5 * camera.width) / focal_length,
                  (y - 0.5 * camera.height) / focal_length,
                  1.0);
}

Vector3d
lidarDirection(const LidarOptions& lidar, double azimuth_steps, int ring)
{
  const double between_rings =
      lidar.rings > 1 ? (lidar.max_elevation - lidar.min_elevation) / (lidar.rings - 1)
                      : 0.0;
  const double elevation =
      (lidar.min_elevation + ring * between_rings) * radians_per_degree;
  const double azimuth = azimuth_steps * lidar.azimuth_step * radians_per_degree;
  return Vector3d(std::cos(elevation) * std::cos(azimuth),
                  std::cos(elevation) * std::sin(azimuth),
                  std::sin(elevation));
}

} // namespace

RayDraws::RayDraws(Random& random)
: jitter_x(random.uniform() - 0.5)
, jitter_y(random.uniform() - 0.5)
, reading(random.normal())
, lateral_x(random.normal())
, lateral_y(random.normal())
, dropout(random.uniform())
, outlier(random.uniform())
, outlier_offset(2.0 * random.uniform() - 1.0)
{}

Beams::Beams(const Scene& scene, const SensorOptions& options, const ScanState& state)
: scene_(scene)
, options_(options)
, state_(state)
{}

std::optional<Vector3d>
Beams::measure(int row, int column, const RayDraws& draws) const
{
  const double x = column + options_.jitter * draws.jitter_x;
  const double y = row + options_.jitter * draws.jitter_y;
  const bool is_camera = options_.kind == SensorKind::DepthCamera;
  // The centre of pixel 0 lies half a pixel inside the image; a ring is never
  // displaced.
  const Vector3d direction =
      is_camera ? cameraDirection(options_.camera, x + 0.5, y + 0.5)
                : lidarDirection(options_.lidar, x + state_.azimuth_phase, row);
  const bool is_displaced = is_camera && options_.camera.lateral_noise > 0.0;
  const auto hit = is_displaced ? castDisplaced(x + 0.5, y + 0.5, column, draws)
                                : cast(direction, column);
  if (!hit)
    return std::nullopt;
  const auto reading = disturbed(*hit, row, draws);
  if (!reading)
    return std::nullopt;
  return *reading * direction;
}

std::optional<Beams::Hit>
Beams::cast(const Vector3d& direction, int column) const
{
  const Eigen::Isometry3d& T_world_sensor = state_.T_world_sensor[column];
  const double length = direction.norm();
  const Ray ray{T_world_sensor.translation(),
                T_world_sensor.linear() * (direction / length)};
  const auto range = castRay(scene_, ray, options_.max_range * length);
  if (!range)
    return std::nullopt;
  const Vector3d normal = surfaceNormal(scene_, ray.origin + *range * ray.direction);
  const double cosine = std::clamp(-normal.dot(ray.direction), 0.0, 1.0);
  return Hit{*range / length, std::acos(cosine)};
}

std::optional<Beams::Hit>
Beams::castDisplaced(double x, double y, int column, const RayDraws& draws) const
{
  const DepthCameraOptions& camera = options_.camera;
  const auto undisplaced = cast(cameraDirection(camera, x, y), column);
  const double angle = undisplaced ? undisplaced->angle_of_incidence : 0.0;
  // The formula has a pole at 90 degrees, far beyond what was measured.
  const double clipped = std::min(angle, 80.0 * radians_per_degree);
  const double sigma =
      camera.lateral_noise * (0.8 + 0.035 * clipped / (0.5 * pi - clipped));
  return cast(
      cameraDirection(camera, x + sigma * draws.lateral_x, y + sigma * draws.lateral_y),
      column);
}

std::optional<double>
Beams::disturbed(const Hit& hit, int row, const RayDraws& draws) const
{
  if (isLost(hit.angle_of_incidence, draws))
    return std::nullopt;
  const double sigma = readingSigma(options_, hit.reading) *
                       incidenceFactor(options_, hit.angle_of_incidence);
  double reading = hit.reading + sigma * draws.reading + state_.offsets[row];
  if (draws.outlier < options_.outliers)
    reading += options_.outlier_spread * draws.outlier_offset;
  reading = quantised(reading);
  if (!(reading >= options_.min_range && reading <= options_.max_range))
    return std::nullopt;
  return reading;
}

bool
Beams::isLost(double angle_of_incidence, const RayDraws& draws) const
{
  const double from = options_.dropout_from * radians_per_degree;
  return angle_of_incidence > from &&
         draws.dropout < (angle_of_incidence - from) / (0.5 * pi - from);
}

double
Beams::quantised(double reading) const
{
  constexpr double kinect_depth_times_disparity = 575.0 * 0.075 * 8.0;
  switch (options_.quantisation) {
  case Quantisation::Kinect:
    return kinect_depth_times_disparity /
           std::round(kinect_depth_times_disparity / reading);
  case Quantisation::Step:
    return options_.quantisation_step *
           std::round(reading / options_.quantisation_step);
  case Quantisation::None:
    break;
  }
  return reading;
}

} // namespace bayesian_icp::simulator
