#include "sensors.h"

#include "beams.h"
#include "noise_field.h"

#include <bayesian_icp/first_exception.h>
#include <bayesian_icp/random.h>

namespace bayesian_icp {
namespace simulator {

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

} // namespace

Scan
scanScene(const Scene& scene,
          const SensorOptions& options,
          const Eigen::Isometry3d& T_world_sensor,
          std::uint64_t seed,
          std::uint32_t scan_number)
{
  validate(options);
  const int rays_per_row = raysPerRow(options);
  const Beams beams(scene, options, T_world_sensor);
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

} // namespace simulator
} // namespace bayesian_icp
