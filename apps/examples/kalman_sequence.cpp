// Fuses odometry with registrations of consecutive scans, and tests the innovations:
//   kalman_sequence FOLDER [METRES RADIANS [SEED]]
// FOLDER has scan_0000.pcd, scan_0001.pcd, ..., poses.txt with one line per scan,
// T_world_sensor as 3x4 row by row, and set.json with accuracy_translation_m and
// accuracy_rotation_rad of the relative poses, each axis. The odometry of a step is the
// motion in poses.txt with noise of METRES and RADIANS in each axis, by default 0.02.
// docs/pose_graph_and_filter.md explains every step.
#include "kalman.h"

#include <bayesian_icp/random.h>

#include <pcl/io/pcd_io.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace {

using namespace kalman;
using boost::math::chi_squared;
using boost::math::quantile;

struct Request {
  std::string folder;
  double metres = 0.02, radians = 0.02; ///< deviations of the odometry's noise
  std::uint64_t seed = 1;
};

template <typename Number>
Number
positive(const std::string& text)
{
  std::istringstream stream(text);
  Number number{};
  const bool is_negative = text.find('-') == 0; // which unsigned numbers would take
  if (is_negative || !(stream >> number) || !stream.eof() || !(number > Number()))
    throw std::invalid_argument("'" + text + "' is not a positive number");
  return number;
}

Request
readArguments(int argc, char** argv)
{
  if (argc != 2 && argc != 4 && argc != 5)
    throw std::invalid_argument(
        "usage: kalman_sequence FOLDER [METRES RADIANS [SEED]]");
  Request request;
  request.folder = argv[1];
  if (argc > 2) {
    request.metres = positive<double>(argv[2]);
    request.radians = positive<double>(argv[3]);
  }
  if (argc > 4)
    request.seed = positive<std::uint64_t>(argv[4]);
  return request;
}

/** Variances of twists from deviations [m, rad]. */
Vector6d
varianceOf(double metres, double radians)
{
  return Vector6d(metres, metres, metres, radians, radians, radians).cwiseAbs2();
}

/** A line of poses.txt, T_world_sensor. */
Eigen::Matrix4d
readPose(const std::string& line)
{
  std::istringstream stream(line);
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  for (Eigen::Index i = 0; i < 12; ++i)
    stream >> pose(i / 4, i % 4);
  const bool is_read = bool(stream) && (stream >> std::ws).eof();
  const Eigen::Matrix4d clean = matrixOf(poseOf(pose)); // the nearest rotation
  if (!is_read || !((clean - pose).norm() < 1e-3))
    throw std::runtime_error("poses.txt: not a 3x4 pose: '" + line + "'");
  return clean;
}

std::vector<Eigen::Matrix4d>
readPoses(const std::string& folder)
{
  std::ifstream stream(folder + "/poses.txt");
  std::vector<Eigen::Matrix4d> poses;
  for (std::string line; std::getline(stream, line);)
    poses.push_back(readPose(line));
  if (poses.size() < 2)
    throw std::runtime_error(folder + "/poses.txt: fewer than two poses");
  return poses;
}

/** Variances of the reference's relative poses [m^2, rad^2]. */
Vector6d
readReferenceVariance(const std::string& folder)
{
  const std::string file = folder + "/set.json";
  std::ifstream stream(file);
  if (!stream)
    throw std::runtime_error(file + ": cannot be read");
  try {
    const auto set = nlohmann::json::parse(stream);
    return varianceOf(set.at("accuracy_translation_m"),
                      set.at("accuracy_rotation_rad"));
  }
  catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

Cloud::Ptr
readScan(const std::string& folder, std::size_t k)
{
  char name[32];
  std::snprintf(name, sizeof(name), "/scan_%04zu.pcd", k);
  const Cloud::Ptr cloud(new Cloud);
  if (pcl::io::loadPCDFile(folder + name, *cloud) < 0)
    throw std::runtime_error(folder + name + ": cannot be read");
  return cloud;
}

/** What the wheels might have measured. It differs from the true motion by the noise
 * and by the error of the reference. */
State
makeOdometry(const Eigen::Matrix4d& reference_motion,
             const Vector6d& noise_variance,
             const Vector6d& reference_variance,
             Random& random)
{
  const Vector6d noise = noise_variance.cwiseSqrt().cwiseProduct(random.normal6());
  return {reference_motion * expSE3(noise),
          (noise_variance + reference_variance).asDiagonal()};
}

/** Sums over registrations. */
struct InnovationTest {
  double nis = 0.0;     ///< normalised innovations squared
  double degrees = 0.0; ///< of freedom
  int count = 0;

  void
  add(double step_nis, int step_degrees)
  {
    nis += step_nis;
    degrees += step_degrees;
    ++count;
  }

  void
  print(const char* which) const
  {
    std::cout << "NIS of the " << count << ' ' << which << " registrations";
    if (count == 0) {
      std::cout << ": nothing to test\n";
      return;
    }
    const chi_squared distribution(degrees);
    const double mean = nis / degrees;
    const double low = quantile(distribution, 0.025) / degrees;
    const double high = quantile(distribution, 0.975) / degrees;
    std::cout << ", per degree of freedom: " << mean << ", "
              << (mean < low    ? "below"
                  : mean > high ? "above"
                                : "within")
              << " its 95 % bounds " << low << " to " << high << '\n';
  }
};

/** The filter, and the odometry alone to compare with. */
struct Robot {
  State fused{Eigen::Matrix4d::Identity(), Matrix6d::Zero()}; ///< in scan 0
  State odometry_alone = fused;
  InnovationTest all, accepted;
  double degrees_of_clouds = 0.0; ///< share of the registrations in accepted.degrees

  /** Odometry and registration measure the same motion and know nothing of each other:
   * one updates the other, if the innovation passes the gate. The result moves the
   * robot. \return what came of it */
  std::string
  move(const State& odometry, const Registration& registration)
  {
    odometry_alone = predict(odometry_alone, odometry);
    if (!registration.is_usable) {
      fused = predict(fused, odometry);
      return "refused (" + registration.message + ")";
    }
    const State& measured = registration.measured;
    const int degrees = 6 - registration.num_unmeasured;
    const double nis = innovation(odometry, measured);
    const bool passes = nis < quantile(chi_squared(degrees), 0.99);
    fused = predict(fused, passes ? update(odometry, measured) : odometry);
    all.add(nis, degrees);
    if (passes) {
      accepted.add(nis, degrees);
      const Matrix6d information = (odometry.P + measured.P).inverse();
      degrees_of_clouds += degrees - (information * odometry.P).trace();
    }
    std::ostringstream text;
    text.precision(3);
    text << "NIS " << nis << " of " << degrees << (passes ? ", accepted" : ", gated");
    return text.str();
  }
};

/** "0.1 m 0.1 rad": how far \p state is from \p reference. */
std::string
errorText(const State& state, const Eigen::Matrix4d& reference)
{
  const Vector6d error = logSE3(state.T.inverse() * reference);
  std::ostringstream text;
  text.precision(3);
  text << error.head<3>().norm() << " m " << error.tail<3>().norm() << " rad";
  return text.str();
}

/** "0.1 m 0.1 rad": the root mean square that \p state expects of errorText(). */
std::string
deviationText(const State& state)
{
  std::ostringstream text;
  text.precision(3);
  text << std::sqrt(state.P.topLeftCorner<3, 3>().trace()) << " m "
       << std::sqrt(state.P.bottomRightCorner<3, 3>().trace()) << " rad";
  return text.str();
}

/** A line per scan. */
Robot
drive(const Request& request)
{
  const std::vector<Eigen::Matrix4d> poses = readPoses(request.folder);
  const Vector6d noise_variance = varianceOf(request.metres, request.radians);
  const Vector6d reference_variance = readReferenceVariance(request.folder);
  Random random(request.seed, 0);
  Robot robot;
  Cloud::ConstPtr target = readScan(request.folder, 0);
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const Cloud::ConstPtr source = readScan(request.folder, k);
    const State odometry = makeOdometry(
        poses[k - 1].inverse() * poses[k], noise_variance, reference_variance, random);
    std::cout << "scan " << k << ": "
              << robot.move(odometry, registerNear(odometry, source, target));
    const Eigen::Matrix4d reference = poses[0].inverse() * poses[k];
    std::cout << "; error of odometry " << errorText(robot.odometry_alone, reference)
              << ", fused " << errorText(robot.fused, reference) << ", stated "
              << deviationText(robot.fused) << std::endl;
    target = source;
  }
  return robot;
}

void
printEnd(const Robot& robot)
{
  robot.all.print("usable");
  robot.accepted.print("accepted");
  std::cout << "gated: " << robot.all.count - robot.accepted.count
            << ", 1 % of the registrations if all is right\n"
            << "degrees of freedom that test the registrations: "
            << robot.degrees_of_clouds << " of " << robot.accepted.degrees
            << "; the rest test the odometry\n";
}

} // namespace

int
main(int argc, char** argv)
{
  try {
    std::cout.precision(4);
    printEnd(drive(readArguments(argc, argv)));
    return 0;
  }
  catch (const std::exception& error) {
    std::cerr << "kalman_sequence: " << error.what() << '\n';
    return 2;
  }
}
