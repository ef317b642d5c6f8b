#include "simulator/sensors.h"

#include "simulator/noise_field.h"
#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace bayesian_icp::simulator {

using Eigen::Isometry3d;
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

/** \brief The random numbers of one ray, drawn whether they are needed or not: a change
 * of one source of error leaves the others as they were. */
struct RayDraws {
  explicit RayDraws(Random& random)
  : jitter_x(random.uniform() - 0.5)
  , jitter_y(random.uniform() - 0.5)
  , reading(random.normal())
  , lateral_x(random.normal())
  , lateral_y(random.normal())
  , dropout(random.uniform())
  , outlier(random.uniform())
  , outlier_offset(2.0 * random.uniform() - 1.0)
  {}

  /** Uniform in [-0.5, 0.5). */
  double jitter_x, jitter_y;
  /** Standard normal. */
  double reading, lateral_x, lateral_y;
  /** Uniform in [0, 1). */
  double dropout, outlier;
  /** Uniform in [-1, 1). */
  double outlier_offset;
};

/** \brief What the rays of one scan have in common. */
struct ScanState {
  /** Pose of the sensor as it takes each column. */
  std::vector<Isometry3d> T_world_sensor;
  /** Added to the readings of each row [m]. */
  std::vector<double> offsets;
  /** Turns all rays of a LiDAR [azimuth steps]. */
  double azimuth_phase = 0.0;
};

double
quantised(const SensorOptions& options, double reading)
{
  constexpr double kinect_depth_times_disparity = 575.0 * 0.075 * 8.0;
  switch (options.quantisation) {
  case Quantisation::Kinect:
    return kinect_depth_times_disparity /
           std::round(kinect_depth_times_disparity / reading);
  case Quantisation::Step:
    return options.quantisation_step * std::round(reading / options.quantisation_step);
  case Quantisation::None:
    break;
  }
  return reading;
}

/** \brief The rays of a sensor in a scene. */
class Beams {
public:
  Beams(const Scene& scene, const SensorOptions& options, const ScanState& state)
  : scene_(scene)
  , options_(options)
  , state_(state)
  {}

  /** \brief The measured point of one ray in the sensor frame [m], if there is one. */
  std::optional<Vector3d>
  measure(int row, int column, const RayDraws& draws) const
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

private:
  struct Hit {
    double reading;
    /** [rad] */
    double angle_of_incidence;
  };

  /** \param[in] direction in the sensor frame, scaled such that the reading times the
   *            direction is the point: of unit depth (camera) or unit length (LiDAR) */
  std::optional<Hit>
  cast(const Vector3d& direction, int column) const
  {
    const Eigen::Isometry3d& T_world_sensor = state_.T_world_sensor[column];
    const double length = direction.norm();
    const Ray ray{T_world_sensor.translation(),
                  T_world_sensor.linear() * (direction / length)};
    const auto range = scene_.castRay(ray, options_.max_range * length);
    if (!range)
      return std::nullopt;
    const Vector3d normal = scene_.surfaceNormal(ray.origin + *range * ray.direction);
    const double cosine = std::clamp(-normal.dot(ray.direction), 0.0, 1.0);
    return Hit{*range / length, std::acos(cosine)};
  }

  /** \brief Where the ray that belongs to a pixel hits after lateral noise. */
  std::optional<Hit>
  castDisplaced(double x, double y, int column, const RayDraws& draws) const
  {
    const DepthCameraOptions& camera = options_.camera;
    const auto undisplaced = cast(cameraDirection(camera, x, y), column);
    const double angle = undisplaced ? undisplaced->angle_of_incidence : 0.0;
    // The formula has a pole at 90 degrees, far beyond what was measured.
    const double clipped = std::min(angle, 80.0 * radians_per_degree);
    const double sigma =
        camera.lateral_noise * (0.8 + 0.035 * clipped / (0.5 * pi - clipped));
    return cast(cameraDirection(
                    camera, x + sigma * draws.lateral_x, y + sigma * draws.lateral_y),
                column);
  }

  /** \brief The reading with all its errors, unless it is lost. */
  std::optional<double>
  disturbed(const Hit& hit, int row, const RayDraws& draws) const
  {
    const double grazing = options_.dropout_from * radians_per_degree;
    if (hit.angle_of_incidence > grazing &&
        draws.dropout < (hit.angle_of_incidence - grazing) / (0.5 * pi - grazing))
      return std::nullopt;
    const double sigma = readingSigma(options_, hit.reading) *
                         incidenceFactor(options_, hit.angle_of_incidence);
    double reading = hit.reading + sigma * draws.reading + state_.offsets[row];
    if (draws.outlier < options_.outliers)
      reading += options_.outlier_spread * draws.outlier_offset;
    reading = quantised(options_, reading);
    if (!(reading >= options_.min_range && reading <= options_.max_range))
      return std::nullopt;
    return reading;
  }

  const Scene& scene_;
  const SensorOptions& options_;
  const ScanState& state_;
};

/** \brief The points that there are.
 * \param[in] points one for each ray */
Scan
scanOf(const std::vector<std::optional<Vector3d>>& points)
{
  Scan scan;
  for (std::size_t ray = 0; ray < points.size(); ++ray)
    if (points[ray])
      scan.ray_indices.push_back(static_cast<std::uint32_t>(ray));
  scan.points.resize(3, static_cast<Eigen::Index>(scan.ray_indices.size()));
  for (Eigen::Index i = 0; i < scan.points.cols(); ++i)
    scan.points.col(i) = *points[scan.ray_indices[i]];
  return scan;
}

/** \brief Streams of random numbers apart from those of rows and of NoiseField. */
constexpr std::uint64_t offset_stream = std::uint64_t{1} << 62;
constexpr std::uint64_t phase_stream = std::uint64_t{3} << 61;

/** \brief The pose of the sensor at each column; see scanScene(). */
std::vector<Isometry3d>
posesOfSweep(const SensorOptions& options,
             const Isometry3d& T_world_sensor,
             const Vector6d& sweep_motion,
             double azimuth_phase)
{
  const int num_columns = raysPerRow(options);
  std::vector<Isometry3d> poses(static_cast<std::size_t>(num_columns), T_world_sensor);
  if (options.kind != SensorKind::Lidar || sweep_motion.isZero(0.0))
    return poses;
  for (int column = 0; column < num_columns; ++column) {
    const double turn = (column + azimuth_phase) / num_columns;
    const double time = turn - std::round(turn);
    poses[column] = T_world_sensor * Isometry3d(expSE3(time * sweep_motion));
  }
  return poses;
}

ScanState
stateOf(const SensorOptions& options,
        const Isometry3d& T_world_sensor,
        const Vector6d& sweep_motion,
        std::uint64_t seed,
        std::uint32_t scan_number)
{
  ScanState state;
  state.offsets.resize(static_cast<std::size_t>(numRows(options)));
  if (options.kind == SensorKind::Lidar) {
    Random offsets(options.lidar.sensor_seed, offset_stream);
    for (double& offset : state.offsets)
      offset = options.lidar.ring_offset * offsets.normal();
    Random phase(seed, phase_stream + scan_number);
    state.azimuth_phase = options.lidar.azimuth_phase * phase.uniform();
  }
  state.T_world_sensor =
      posesOfSweep(options, T_world_sensor, sweep_motion, state.azimuth_phase);
  return state;
}

} // namespace

Scan
scanScene(const Scene& scene,
          const SensorOptions& options,
          const Eigen::Isometry3d& T_world_sensor,
          std::uint64_t seed,
          std::uint32_t scan_number,
          const Vector6d& sweep_motion)
{
  validate(options);
  const int rays_per_row = raysPerRow(options);
  const ScanState state =
      stateOf(options, T_world_sensor, sweep_motion, seed, scan_number);
  const Beams beams(scene, options, state);
  const NoiseField noise_field(options, seed, scan_number);
  std::vector<std::optional<Vector3d>> points(
      static_cast<std::size_t>(numRows(options)) * rays_per_row);
  forEachPiece(numRows(options), 0, [&](int row) {
    // A stream of random numbers per row: the same for any number of threads.
    Random random(seed, (std::uint64_t{scan_number} << 32) + row);
    for (int column = 0; column < rays_per_row; ++column) {
      RayDraws draws(random);
      draws.reading = noise_field.mixed(draws.reading, row, column);
      points[std::size_t(row) * rays_per_row + column] =
          beams.measure(row, column, draws);
    }
  });
  return scanOf(points);
}

} // namespace bayesian_icp::simulator
