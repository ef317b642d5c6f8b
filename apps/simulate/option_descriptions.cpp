#include "simulate/option_descriptions.h"

#include <boost/program_options/value_semantic.hpp>

#include <string>

namespace bayesian_icp::simulator {

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
  group.add_options()("help,h", "Show this text.");
  group.add_options()(
      "list-scenes",
      "List the scenes, with the motions that each leaves unobservable.");
  group.add_options()("scene", text("NAME"), "Scene to scan. (required)");
  group.add_options()("output,o",
                      text("DIR"),
                      "Folder to write to; it is made if it is missing. (required)");
  group.add_options()("seed", text("N"), "Seed of the noise, 0 to 2^64-1. (default 1)");
  return group;
}

po::options_description
viewOptions()
{
  po::options_description group(
      "Views and frames (world frame, z up; defaults depend on the scene)");
  group.add_options()(
      "target-eye", text("X,Y,Z"), "Position of the target's sensor [m].");
  group.add_options()(
      "target-look-at", text("X,Y,Z"), "Point at which the target's sensor looks [m].");
  group.add_options()(
      "source-eye", text("X,Y,Z"), "Position of the source's sensor [m].");
  group.add_options()(
      "source-look-at", text("X,Y,Z"), "Point at which the source's sensor looks [m].");
  group.add_options()("same-view",
                      "Scan the source from the target's view. Without it, the source "
                      "has its own view.");
  group.add_options()("frame",
                      text("FRAME"),
                      "Frame of the clouds: 'object' (the world frame) or 'sensor'.");
  group.add_options()("offset",
                      text("X,Y,Z,ROLL,PITCH,YAW"),
                      "Pose [m, rad] whose inverse moves the source before it is "
                      "written. With --frame object it is the true source-to-target "
                      "pose.");
  group.add_options()(
      "sweep-motion",
      text("PART"),
      "Part, 0 to 1, of the motion from the target's to the source's view that a lidar "
      "makes at constant velocity during one turn, which begins and ends at the back. "
      "The points are not corrected for it; the true pose is that in the middle of "
      "both turns. With 1 the second scan follows the first immediately. (default 0)");
  return group;
}

po::options_description
sensorOptions()
{
  po::options_description group("Sensor");
  group.add_options()(
      "sensor",
      text("KIND"),
      "Kind of sensor: depth-camera, lidar, or a spinning lidar of a car's roof: "
      "lidar16, lidar32 (-15 to 15 degrees, every 0.2), lidar64, lidar128 (-25 to 5 "
      "degrees, every 0.25). Those of a car see 1 to 80 m and have --incidence-noise "
      "0.25 --ring-offset 0.01 --azimuth-phase 1. The other options change these "
      "values. (default depends on the scene)");
  group.add_options()("width", text("N"), "Camera: columns [pixels]. (default 640)");
  group.add_options()("height", text("N"), "Camera: rows [pixels]. (default 480)");
  group.add_options()(
      "fov", text("DEG"), "Camera: horizontal field of view [degrees]. (default 57)");
  group.add_options()(
      "rings",
      text("N"),
      "Lidar: number of rings. (default 16; most scenes with a lidar 32)");
  group.add_options()(
      "min-elevation",
      text("DEG"),
      "Lidar: lowest ring [degrees]. (default -15; most scenes with a lidar -30)");
  group.add_options()(
      "max-elevation",
      text("DEG"),
      "Lidar: highest ring [degrees]. (default 15; most scenes with a lidar 10)");
  group.add_options()("azimuth-step",
                      text("DEG"),
                      "Lidar: angle between rays [degrees]. (default 0.4)");
  group.add_options()("azimuth-phase",
                      text("PART"),
                      "Lidar: turn all rays of a scan by a random part of an azimuth "
                      "step, at most this part, 0 to 1. (default 0)");
  group.add_options()("min-range",
                      text("M"),
                      "Nearest reading [m]. (default 0.3; lidar16 to lidar128 1)");
  group.add_options()(
      "max-range",
      text("M"),
      "Farthest reading [m]. (default: camera 5, lidar 30, lidar16 to lidar128 80)");
  return group;
}

po::options_description
noiseOptions()
{
  po::options_description group(
      "Noise of the readings (depth or range; independent in source and target)");
  group.add_options()(
      "noise",
      text("FACTOR"),
      "Factor on the noise of the reading; 0 means no noise. Camera: 0.0012 + 0.0019 "
      "(z - 0.4)^2 m at depth z (Kinect, Nguyen 2012). (default 1)");
  group.add_options()("range-noise",
                      text("M"),
                      "Lidar: standard deviation of the range [m]. (default 0.02)");
  group.add_options()("noise-correlation",
                      text("PART"),
                      "Part of the variance of the reading's noise, 0 to 1, that "
                      "neighbouring rays share. (default 0)");
  group.add_options()("noise-correlation-pixels",
                      text("N"),
                      "Standard deviation of the Gaussian that smooths the shared part "
                      "[pixels; rings and azimuth steps]. (default 2.5)");
  group.add_options()("incidence-noise",
                      text("POWER"),
                      "Divide the noise of the reading by cos(angle of incidence) to "
                      "this power, 0 to 4; time-of-flight cameras have about 1. It "
                      "grows tenfold at most. (default 0)");
  return group;
}

po::options_description
errorOptions()
{
  po::options_description group("Other errors of the sensor");
  group.add_options()("ring-offset",
                      text("M"),
                      "Lidar: standard deviation of the rings' constant offsets of the "
                      "range [m], the same in both scans. (default 0)");
  group.add_options()("sensor-seed",
                      text("N"),
                      "Lidar: seed of these offsets, 0 to 2^64-1. (default 1)");
  group.add_options()("lateral-noise",
                      text("FACTOR"),
                      "Camera: factor on the noise across the ray, about 0.8 pixels "
                      "(Kinect, Nguyen 2012). (default 0)");
  group.add_options()("quantisation",
                      text("KIND"),
                      "Rounding of the readings: none, kinect (camera: 345 m / k, 3 mm "
                      "at 1 m) or a step [m]. (default none)");
  group.add_options()(
      "dropout-from",
      text("DEG"),
      "Angle of incidence [degrees] from which readings get lost, with a probability "
      "that reaches 1 at 90. (default 90: none)");
  group.add_options()(
      "outliers", text("P"), "Probability of a wrong reading, 0 to 1. (default 0)");
  group.add_options()("outlier-spread",
                      text("M"),
                      "Largest error of a wrong reading [m]. (default 0.1)");
  group.add_options()(
      "jitter",
      text("PART"),
      "Move each ray at random within this part, 0 to 1, of a pixel or "
      "azimuth step. 0 is the fixed grid of a real sensor. (default 0)");
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

} // namespace bayesian_icp::simulator
