#include "option_descriptions.h"

#include <boost/program_options/value_semantic.hpp>

#include <string>

namespace bayesian_icp {
namespace simulator {

namespace po = boost::program_options;

namespace {

po::typed_value<std::string>*
text(const char* placeholder)
{
  return po::value<std::string>()->value_name(placeholder);
}

po::options_description
generalOptions()
{
  po::options_description group("General");
  group.add_options()("help,h", "show this text");
  group.add_options()("list-scenes",
                      "list the scenes, with what is unobservable in them");
  group.add_options()("scene", text("NAME"), "the scene to scan (required)");
  group.add_options()(
      "output,o", text("DIR"), "folder to write to, made if missing (required)");
  group.add_options()("seed", text("N"), "seed of the noise, 0 .. 2^64-1 (default 1)");
  return group;
}

po::options_description
viewOptions()
{
  po::options_description group(
      "Views and frames (world frame, z up; defaults depend on "
      "the scene)");
  group.add_options()(
      "target-eye", text("X,Y,Z"), "where the target's sensor stands [m]");
  group.add_options()("target-look-at", text("X,Y,Z"), "where it looks [m]");
  group.add_options()(
      "source-eye", text("X,Y,Z"), "where the source's sensor stands [m]");
  group.add_options()("source-look-at", text("X,Y,Z"), "where it looks [m]");
  group.add_options()("same-view", "take the source from the target's view too");
  group.add_options()("frame",
                      text("FRAME"),
                      "frame of the clouds: 'object' (the world frame) or 'sensor'");
  group.add_options()(
      "offset",
      text("X,Y,Z,ROLL,PITCH,YAW"),
      "pose [m, rad] whose inverse moves the source before it is written; "
      "with --frame object it is the true source-to-target pose");
  group.add_options()(
      "sweep-motion",
      text("PART"),
      "lidar: part of the motion from the target's to the source's view, 0 to 1, that "
      "the sensor makes at constant velocity while it turns once, from the back to the "
      "back; nothing corrects the points, and the true pose is that of the middle of "
      "both turns. 1: the two scans follow each other at once (default 0)");
  return group;
}

po::options_description
sensorOptions()
{
  po::options_description group("Sensor");
  group.add_options()(
      "sensor",
      text("KIND"),
      "depth-camera, lidar, or a spinning lidar as on a car's roof: lidar16, lidar32 "
      "(-15 to 15 degrees, every 0.2), lidar64, lidar128 (-25 to 5 degrees, every "
      "0.25), 1 to 80 m, --incidence-noise 0.25 --ring-offset 0.01 --azimuth-phase 1; "
      "the "
      "other "
      "options change each of these (default depends on the scene)");
  group.add_options()("width", text("N"), "camera: columns [pixels] (default 640)");
  group.add_options()("height", text("N"), "camera: rows [pixels] (default 480)");
  group.add_options()(
      "fov", text("DEG"), "camera: horizontal field of view [degrees] (default 57)");
  group.add_options()(
      "rings", text("N"), "lidar: rings (default 16; most scenes with a lidar 32)");
  group.add_options()(
      "min-elevation",
      text("DEG"),
      "lidar: lowest ring [degrees] (default -15; most scenes with a lidar -30)");
  group.add_options()(
      "max-elevation",
      text("DEG"),
      "lidar: highest ring [degrees] (default 15; most scenes with a lidar 10)");
  group.add_options()(
      "azimuth-step", text("DEG"), "lidar: between rays [degrees] (default 0.4)");
  group.add_options()("azimuth-phase",
                      text("PART"),
                      "lidar: turn all rays of a scan by a random part of an azimuth "
                      "step, up to this one, 0 to 1 (default 0)");
  group.add_options()("min-range",
                      text("M"),
                      "nearest reading [m] (default 0.3; lidar16 to lidar128 1)");
  group.add_options()(
      "max-range",
      text("M"),
      "farthest reading [m] (default: camera 5, lidar 30, lidar16 to lidar128 80)");
  return group;
}

po::options_description
noiseOptions()
{
  po::options_description group(
      "Noise of the readings (a reading is a camera's depth or a "
      "LiDAR's range; independent in source and target)");
  group.add_options()(
      "noise",
      text("FACTOR"),
      "factor on the noise of the reading, 0 for none (default 1); camera: "
      "0.0012 + 0.0019 (z - 0.4)^2 m at depth z (Kinect, Nguyen 2012)");
  group.add_options()("range-noise",
                      text("M"),
                      "lidar: standard deviation of the range [m] (default 0.02)");
  group.add_options()("noise-correlation",
                      text("PART"),
                      "part of the variance of the reading's noise, 0 to 1, that "
                      "neighbouring rays share (default 0)");
  group.add_options()("noise-correlation-pixels",
                      text("N"),
                      "standard deviation of the Gaussian that smooths the shared part "
                      "[pixels; rings and azimuth steps] (default 2.5)");
  group.add_options()("incidence-noise",
                      text("POWER"),
                      "divide the noise of the reading by cos(angle of incidence) to "
                      "this power, 0 to 4; it grows tenfold at most (time-of-flight "
                      "camera: about 1) (default 0)");
  return group;
}

po::options_description
errorOptions()
{
  po::options_description group("Other errors of the sensor");
  group.add_options()("ring-offset",
                      text("M"),
                      "lidar: standard deviation of the rings' constant offsets of the "
                      "range [m], the same in both scans (default 0)");
  group.add_options()("sensor-seed",
                      text("N"),
                      "lidar: seed of these offsets, 0 .. 2^64-1 (default 1)");
  group.add_options()("lateral-noise",
                      text("FACTOR"),
                      "camera: factor on the noise across the ray, about 0.8 pixels "
                      "(Kinect, Nguyen 2012) (default 0)");
  group.add_options()("quantisation",
                      text("KIND"),
                      "none, kinect (camera: 345 m / k, 3 mm at 1 m) or a step [m] "
                      "(default none)");
  group.add_options()(
      "dropout-from",
      text("DEG"),
      "angle of incidence [degrees] from which readings get lost, with a "
      "probability that reaches 1 at 90 (default 90: none)");
  group.add_options()(
      "outliers", text("P"), "probability of a wrong reading, 0 to 1 (default 0)");
  group.add_options()("outlier-spread",
                      text("M"),
                      "wrong readings are off by at most this [m] (default 0.1)");
  group.add_options()("jitter",
                      text("PART"),
                      "move each ray at random within this part, 0 to 1, of a pixel or "
                      "azimuth step; 0 is the fixed grid of a real sensor (default 0)");
  return group;
}

} // namespace

po::options_description
allOptions()
{
  po::options_description all;
  all.add(generalOptions())
      .add(viewOptions())
      .add(sensorOptions())
      .add(noiseOptions())
      .add(errorOptions());
  return all;
}

} // namespace simulator
} // namespace bayesian_icp
