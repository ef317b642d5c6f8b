/** \file
 * \brief The one table of what decides a simulation: names on the command line and in
 * scene.json, the values that are allowed, and descriptions.
 */
#pragma once

#include "simulator/simulation.h"

#include <limits>

namespace bayesian_icp::simulator {

/** \brief The numbers that an option may be. */
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  /** Whether \p lowest itself is out of it. */
  bool is_open = false;
};

constexpr Range not_negative = {0.0, std::numeric_limits<double>::max()};
constexpr Range positive = {0.0, std::numeric_limits<double>::max(), true};
constexpr Range part_of_all = {0.0, 1.0};

/** \brief Parts of the help. */
enum class OptionGroup { General, Views, Sensor, Noise, Errors };

/** \brief How users call one option. */
struct OptionField {
  OptionGroup group;
  /** On the command line and in scene.json. */
  const char* name;
  const char* placeholder;
  const char* help;
  Range range = {};
  /** Why it has no effect, and is not in scene.json; null if it has one. */
  const char* no_effect = nullptr;
};

// clang-format off
/** \brief Call visit(field, value) for every option of a sensor; the kind, which comes
 * first, and the quantisation decide others when they are read. */
template <typename SensorT, typename Visitor>
void
visitSensor(SensorT& sensor, const Visitor& visit)
{
  using Group = OptionGroup;
  const bool is_camera = sensor.kind == SensorKind::DepthCamera;
  const char* no_camera = is_camera ? nullptr : "with a lidar";
  const char* no_lidar = is_camera ? "with a depth-camera" : nullptr;
  auto& camera = sensor.camera;
  auto& lidar = sensor.lidar;
  const char* no_factor = sensor.noise > 0.0 ? nullptr : "with --noise 0";
  const char* no_noise =
      is_camera || lidar.range_noise > 0.0 ? no_factor : "with --range-noise 0";
  visit({Group::Sensor, "sensor", "KIND",
         "Kind of sensor: depth-camera, lidar, or a spinning lidar on the roof of a "
         "car: lidar16, lidar32 (-15 to 15 degrees, every 0.2), lidar64, lidar128 (-25 "
         "to 5 degrees, every 0.25). Car lidars see 1 to 80 m and have "
         "--incidence-noise 0.25 --ring-offset 0.01 --azimuth-phase 1. The other "
         "options override these values. (default depends on the scene)"}, sensor.kind);
  visit({Group::Sensor, "width", "N", "Camera: columns [pixels]. (default 640)",
         {1, 8192}, no_camera}, camera.width);
  visit({Group::Sensor, "height", "N", "Camera: rows [pixels]. (default 480)",
         {1, 8192}, no_camera}, camera.height);
  visit({Group::Sensor, "fov", "DEG",
         "Camera: horizontal field of view [degrees]. (default 57)",
         {0.1, 170.0}, no_camera}, camera.horizontal_fov);
  visit({Group::Errors, "lateral-noise", "FACTOR",
         "Camera: factor on the noise across the ray, about 0.8 pixels (Kinect, Nguyen "
         "2012). (default 0)", not_negative, no_camera}, camera.lateral_noise);
  visit({Group::Sensor, "rings", "N",
         "Lidar: number of rings. (default 16; most scenes with a lidar 32)",
         {1, 1024}, no_lidar}, lidar.rings);
  visit({Group::Sensor, "min-elevation", "DEG",
         "Lidar: lowest ring [degrees]. (default -15; most scenes with a lidar -30)",
         {-90.0, 90.0}, no_lidar}, lidar.min_elevation);
  visit({Group::Sensor, "max-elevation", "DEG",
         "Lidar: highest ring [degrees]. (default 15; most scenes with a lidar 10)",
         {lidar.min_elevation, 90.0}, no_lidar}, lidar.max_elevation);
  visit({Group::Sensor, "azimuth-step", "DEG",
         "Lidar: angle between rays [degrees]. (default 0.4)",
         {0.01, 180.0}, no_lidar}, lidar.azimuth_step);
  visit({Group::Sensor, "azimuth-phase", "PART",
         "Lidar: turn all rays of a scan by a random fraction of an azimuth step, at "
         "most this fraction, 0 to 1. (default 0)", part_of_all, no_lidar},
        lidar.azimuth_phase);
  visit({Group::Noise, "range-noise", "M",
         "Lidar: standard deviation of the range [m]. (default 0.02)",
         not_negative, is_camera ? no_lidar : no_factor}, lidar.range_noise);
  visit({Group::Errors, "ring-offset", "M",
         "Lidar: standard deviation of the rings' constant range offsets [m], which "
         "are the same in both scans. (default 0)", not_negative, no_lidar},
        lidar.ring_offset);
  visit({Group::Errors, "sensor-seed", "N",
         "Lidar: seed of these offsets, 0 to 2^64-1. (default 1)", {},
         is_camera || lidar.ring_offset > 0.0 ? no_lidar : "without --ring-offset"},
        lidar.sensor_seed);
  visit({Group::Sensor, "min-range", "M",
         "Nearest reading [m]. (default 0.3; lidar16 to lidar128 1)", positive},
        sensor.min_range);
  visit({Group::Sensor, "max-range", "M",
         "Farthest reading [m]. (default: camera 5, lidar 30, lidar16 to lidar128 80)",
         positive}, sensor.max_range);
  visit({Group::Noise, "noise", "FACTOR",
         "Factor on the noise of the reading; 0 means no noise. Camera: 0.0012 + 0.0019 "
         "(z - 0.4)^2 m at depth z (Kinect, Nguyen 2012). (default 1)", not_negative,
         no_factor == nullptr ? no_noise : nullptr}, sensor.noise);
  visit({Group::Noise, "noise-correlation", "PART",
         "Fraction of the variance of the reading's noise, 0 to 1, that neighbouring "
         "rays share. (default 0)", part_of_all,
         sensor.noise_correlation > 0.0 ? no_noise : "at 0"}, sensor.noise_correlation);
  visit({Group::Noise, "noise-correlation-pixels", "N",
         "Standard deviation of the Gaussian that smooths the shared part [pixels; "
         "rings and azimuth steps]. (default 2.5)", {0.1, 100.0},
         sensor.noise_correlation > 0.0 ? no_noise : "without --noise-correlation"},
        sensor.noise_correlation_pixels);
  visit({Group::Noise, "incidence-noise", "POWER",
         "Divide the noise of the reading by cos(angle of incidence) to this power, 0 "
         "to 4; time-of-flight cameras have about 1. It grows tenfold at most. (default "
         "0)", {0.0, 4.0},
         !is_camera || sensor.incidence_noise > 0.0 ? no_noise : "at 0"},
        sensor.incidence_noise);
  visit({Group::Errors, "quantisation", "KIND",
         "Rounding of the readings: none, kinect (camera: 345 m / k, 3 mm at 1 m) or a "
         "step [m]. (default none)"}, sensor.quantisation);
  visit({Group::Errors, "dropout-from", "DEG",
         "Angle of incidence [degrees] from which readings are lost, with a "
         "probability that reaches 1 at 90. (default 90: none)", {0.0, 90.0}},
        sensor.dropout_from);
  visit({Group::Errors, "outliers", "P",
         "Probability of a wrong reading, 0 to 1. (default 0)", part_of_all},
        sensor.outliers);
  visit({Group::Errors, "outlier-spread", "M",
         "Largest error of a wrong reading [m]. (default 0.1)", not_negative,
         sensor.outliers > 0.0 ? nullptr : "without --outliers"}, sensor.outlier_spread);
  visit({Group::Errors, "jitter", "PART",
         "Move each ray at random within this fraction, 0 to 1, of a pixel or azimuth "
         "step. 0 is the fixed grid of a real sensor. (default 0)", part_of_all},
        sensor.jitter);
}

/** \brief Call visit(field, value) for every option of a pair. The scene comes first,
 * because it decides the defaults of the others. */
template <typename OptionsT, typename Visitor>
void
visitOptions(OptionsT& options, const Visitor& visit)
{
  using Group = OptionGroup;
  visit({Group::General, "scene", "NAME", "Scene to scan. (required)"}, options.scene);
  visit({Group::General, "seed", "N", "Seed of the noise, 0 to 2^64-1. (default 1)"},
        options.seed);
  visit({Group::Views, "target-eye", "X,Y,Z", "Position of the target's sensor [m]."},
        options.target_view.eye);
  visit({Group::Views, "target-look-at", "X,Y,Z",
         "Point at which the target's sensor looks [m]."}, options.target_view.look_at);
  visit({Group::Views, "source-eye", "X,Y,Z", "Position of the source's sensor [m]."},
        options.source_view.eye);
  visit({Group::Views, "source-look-at", "X,Y,Z",
         "Point at which the source's sensor looks [m]."}, options.source_view.look_at);
  visit({Group::Views, "frame", "FRAME",
         "Frame of the clouds: 'object' (the world frame) or 'sensor'."}, options.frame);
  visit({Group::Views, "offset", "X,Y,Z,ROLL,PITCH,YAW",
         "Pose [m, rad] whose inverse moves the source before it is written. With "
         "--frame object it is the true source-to-target pose."}, options.offset);
  visit({Group::Views, "sweep-motion", "PART",
         "Fraction, 0 to 1, of the motion from the target's to the source's view that "
         "a lidar makes at constant velocity during one turn, which begins and ends at "
         "the back. The points are not corrected for it. The true pose is that between "
         "the middles of both turns. With 1 the second scan follows the first "
         "immediately. (default 0)", {}, options.sweep_motion > 0.0 ? nullptr : "at 0"},
        options.sweep_motion);
  visitSensor(options.sensor, visit);
}

// clang-format on
} // namespace bayesian_icp::simulator
