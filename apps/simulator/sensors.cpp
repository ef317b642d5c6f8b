#include "simulator/sensors.h"

#include "simulator/beams.h"
#include "simulator/noise_field.h"
#include "threads/first_exception.h"

#include <bayesian_icp/random.h>

#include <cmath>

namespace bayesian_icp::simulator {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** \brief The points of one image row or ring, with their columns. */
struct ScanRow {
  std::vector<Vector3d> points;
  std::vector<int> columns;
};

Scan
joinRows(const std::vector<ScanRow>& rows, int rays_per_row)
{
  Scan scan;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (const int column : rows[row].columns)
      scan.ray_indices.push_back(
          static_cast<std::uint32_t>(row * rays_per_row + column));
  scan.points.resize(3, static_cast<Eigen::Index>(scan.ray_indices.size()));
  Eigen::Index next = 0;
  for (const ScanRow& row : rows)
    for (const Vector3d& point : row.points)
      scan.points.col(next++) = point;
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
  std::vector<ScanRow> rows(static_cast<std::size_t>(numRows(options)));
  FirstException failure;
#pragma omp parallel for schedule(dynamic)
  for (int row = 0; row < numRows(options); ++row)
    failure.guard([&] {
      // A stream of random numbers per row: the same for any number of threads.
      Random random(seed, (std::uint64_t{scan_number} << 32) + row);
      for (int column = 0; column < rays_per_row; ++column) {
        RayDraws draws(random);
        draws.reading = noise_field.mixed(draws.reading, row, column);
        const auto point = beams.measure(row, column, draws);
        if (!point)
          continue;
        rows[row].points.push_back(*point);
        rows[row].columns.push_back(column);
      }
    });
  failure.rethrow();
  return joinRows(rows, rays_per_row);
}

} // namespace bayesian_icp::simulator
