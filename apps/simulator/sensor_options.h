/** \file
 * \brief Depth camera and spinning LiDAR: their rays and their errors.
 *
 * What a camera measures is the depth along its z axis, what a LiDAR measures is the
 * range along the ray; "reading" below stands for either [m].
 */
#pragma once

#include <cstdint>

namespace bayesian_icp::simulator {

enum class SensorKind { DepthCamera, Lidar };

/** \brief A pin-hole depth camera; the defaults are those of a Kinect. */
struct DepthCameraOptions {
  /** Columns and rows of the image [pixels]. */
  int width = 640;
  int height = 480;
  /** Horizontal field of view [degrees]; the pixels are square. */
  double horizontal_fov = 57.0;
  /** Factor on the lateral noise of Nguyen et al. 2012, a displacement of each pixel's
   * ray with standard deviation 0.8 + 0.035 a / (pi/2 - a) pixels, a the angle of
   * incidence; the depth is reported at the undisplaced pixel. */
  double lateral_noise = 0.0;
};

/** \brief A spinning LiDAR; the defaults are those of a common 16-ring sensor. */
struct LidarOptions {
  int rings = 16;
  /** Elevation of the lowest and the highest ring [degrees], the others evenly between.
   */
  double min_elevation = -15.0;
  double max_elevation = 15.0;
  /** Angle between two rays of a ring [degrees]. */
  double azimuth_step = 0.4;
  /** Standard deviation of the range [m]. */
  double range_noise = 0.02;
  /** Standard deviation of the offsets of the rings [m]: each ring of one sensor adds a
   * number of its own to all its ranges, the same in every scan. */
  double ring_offset = 0.0;
  /** Which sensor: determines the offsets of the rings. */
  std::uint64_t sensor_seed = 1;
  /** All rays of a scan are turned about the sensor's axis by a random number, uniform
   * between 0 and this part of an azimuth step. */
  double azimuth_phase = 0.0;
};

enum class Quantisation {
  None,
  /** Disparity in eighths of a pixel, focal length 575 pixels, base line 75 mm: depths
   * of 345 m / k, k integer; steps of 3 mm at 1 m. Camera only. */
  Kinect,
  /** Multiples of quantisation_step. */
  Step
};

struct SensorOptions {
  SensorKind kind = SensorKind::DepthCamera;
  DepthCameraOptions camera;
  LidarOptions lidar;
  /** Factor on the noise of the reading: 0.0012 + 0.0019 (z - 0.4)^2 m at depth z
   * (camera, Nguyen et al. 2012), or LidarOptions::range_noise. */
  double noise = 1.0;
  /** Part of the variance of that noise, 0 to 1, that neighbouring rays share: a field
   * that is smooth over the rows and columns of the scan. */
  double noise_correlation = 0.0;
  /** Standard deviation of the Gaussian that smooths the field [pixels; rings and
   * azimuth steps of a LiDAR]. */
  double noise_correlation_pixels = 2.5;
  /** Power p of the factor incidenceFactor() on the noise of the reading, as of
   * time-of-flight cameras; 0 for none. */
  double incidence_noise = 0.0;
  Quantisation quantisation = Quantisation::None;
  /** [m] */
  double quantisation_step = 0.0;
  /** Angle of incidence [degrees] from which rays get lost; the probability grows
   * linearly from 0 there to 1 at 90 degrees. */
  double dropout_from = 90.0;
  /** Probability that a reading is off by a uniform number in +-outlier_spread [m]. */
  double outliers = 0.0;
  double outlier_spread = 0.1;
  /** Each ray is moved at random, uniformly within this part of a pixel (camera) or of
   * an azimuth step (LiDAR). The sensor knows it: the point lies on the moved ray. 0
   * keeps the fixed grid of a real sensor, the same in both scans. */
  double jitter = 0.0;
  /** Readings outside are lost [m]. */
  double min_range = 0.3;
  double max_range = 5.0;
};

/** \brief A spinning LiDAR as on the roof of a car: 16 or 32 rings between -15 and 15
 * degrees every 0.2 degrees, or 64 or 128 between -25 and 5 every 0.25 degrees; 1 to
 * 80 m. Noise grows with the angle of incidence as little as that of an HDL-64E on a
 * road (8 mm at 20 degrees of elevation, 11 mm at 4), rings have offsets of 0.01 m, and
 * the azimuths of two scans have nothing in common.
 * \throws std::invalid_argument of another number of rings */
SensorOptions
carLidar(int rings);

/** \brief Number of image rows or rings. */
int
numRows(const SensorOptions& options);

/** \brief Number of rays of one image row or one ring. */
int
raysPerRow(const SensorOptions& options);

/** \brief Standard deviation of a reading at perpendicular incidence [m]. */
double
readingSigma(const SensorOptions& options, double reading);

/** \brief Factor on readingSigma() at an angle of incidence [rad]:
 * 1 / cos(angle)^SensorOptions::incidence_noise, but at most 10. */
double
incidenceFactor(const SensorOptions& options, double angle_of_incidence);

/** \brief Check every field.
 * \throws std::invalid_argument naming the option of the command line that sets it, the
 * value and what is allowed */
void
validate(const SensorOptions& options);

} // namespace bayesian_icp::simulator
