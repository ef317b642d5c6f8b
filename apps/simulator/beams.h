/** \file
 * \brief One ray of a sensor, and all that can happen to its reading.
 */
#pragma once

#include "simulator/scenes.h"
#include "simulator/sensor_options.h"

#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

#include <optional>
#include <vector>

namespace bayesian_icp::simulator {

/** \brief The random numbers of one ray, drawn whether they are needed or not: a change
 * of one source of error leaves the others as they were. */
struct RayDraws {
  explicit RayDraws(Random& random);

  /** Uniform in [-0.5, 0.5). */
  double jitter_x;
  double jitter_y;
  /** Standard normal. */
  double reading;
  double lateral_x;
  double lateral_y;
  /** Uniform in [0, 1). */
  double dropout;
  double outlier;
  /** Uniform in [-1, 1). */
  double outlier_offset;
};

/** \brief What the rays of one scan have in common. */
struct ScanState {
  /** Pose of the sensor as it takes each column. */
  std::vector<Eigen::Isometry3d> T_world_sensor;
  /** Added to the readings of each row [m]. */
  std::vector<double> offsets;
  /** Turns all rays of a LiDAR [azimuth steps]. */
  double azimuth_phase = 0.0;
};

/** \brief The rays of a sensor in a scene. Keeps references to all three. */
class Beams {
public:
  Beams(const Scene& scene, const SensorOptions& options, const ScanState& state);

  /** \brief The measured point of one ray in the sensor frame [m], if there is one. */
  std::optional<Eigen::Vector3d>
  measure(int row, int column, const RayDraws& draws) const;

private:
  struct Hit {
    double reading;
    /** [rad] */
    double angle_of_incidence;
  };

  /** \param[in] direction in the sensor frame, scaled such that the reading times the
   *            direction is the point: of unit depth (camera) or unit length (LiDAR) */
  std::optional<Hit>
  cast(const Eigen::Vector3d& direction, int column) const;

  /** \brief Where the ray that belongs to a pixel hits after lateral noise. */
  std::optional<Hit>
  castDisplaced(double x, double y, int column, const RayDraws& draws) const;

  std::optional<double>
  disturbed(const Hit& hit, int row, const RayDraws& draws) const;

  bool
  isLost(double angle_of_incidence, const RayDraws& draws) const;

  double
  quantised(double reading) const;

  const Scene& scene_;
  const SensorOptions& options_;
  const ScanState& state_;
};

} // namespace bayesian_icp::simulator
