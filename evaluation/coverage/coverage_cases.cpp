#include "coverage/coverage_cases.h"

#include "io/text_hash.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

namespace bayesian_icp::evaluate {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using simulator::SensorKind;
using simulator::SensorOptions;
using simulator::View;

namespace {

/** \brief Prior of condition `far` [m, rad]. */
const Vector6d far_prior_sd = (Vector6d() << 1.0, 1.0, 1.0, 0.8, 0.8, 0.8).finished();

/** \brief Conditions with other numbers of points, and what the sensors' resolution is
 * multiplied by. */
const std::map<std::string, double> densities = {{"points_quarter", 0.5},
                                                 {"points_x4", 2.0},
                                                 {"points_x16", 4.0},
                                                 {"points_x64", 8.0}};

/** \brief Sensors and views of both scans, and the part of the target that gets lost.
 */
struct ScanPlan {
  SensorOptions source_sensor;
  SensorOptions target_sensor;
  View source_view;
  View target_view;
  double lost_part = 0.0;
  /** Motion during each scan; see scanScene(). */
  Vector6d sweep_motion = Vector6d::Zero();
};

/** \brief Multiply the pixels of a row and of a column, or rings and azimuths. */
void
scaleResolution(double factor, SensorOptions& sensor)
{
  const auto scale = [factor](int& count) {
    count = static_cast<int>(std::lround(factor * count));
  };
  scale(sensor.camera.width);
  scale(sensor.camera.height);
  scale(sensor.lidar.rings);
  sensor.lidar.azimuth_step /= factor;
}

void
correlateNoise(SensorOptions& sensor)
{
  sensor.noise_correlation = 0.7;
  const bool is_camera = sensor.kind == SensorKind::DepthCamera;
  sensor.quantisation =
      is_camera ? simulator::Quantisation::Kinect : simulator::Quantisation::Step;
  sensor.quantisation_step = 0.01;
}

void
addOutliers(SensorOptions& sensor)
{
  sensor.outliers = 0.05;
  // Uniform within +-spread, so with a standard deviation of 0.1 m.
  sensor.outlier_spread = 0.1 * std::sqrt(3.0);
}

[[noreturn]] void
refuseCondition(const std::string& condition)
{
  throw std::invalid_argument("the coverage study has no condition '" + condition +
                              "' of such a scene");
}

ScanPlan
planScans(const CoverageSetup& setup, const std::string& condition, Random& random)
{
  ScanPlan plan{setup.sensor, setup.sensor, setup.view, setup.view};
  if (condition == "moved" || condition == "far")
    plan.source_view = secondView(setup, 1.0, random);
  else if (condition == "clean_target" || condition == "exact_target") {
    plan.source_view = secondView(setup, 1.0, random);
    plan.target_sensor.noise *= condition == "clean_target" ? 0.1 : 0.0;
  }
  else if (condition == "half")
    scaleResolution(0.5, plan.source_sensor);
  else if (const auto found = densities.find(condition); found != densities.end()) {
    scaleResolution(found->second, plan.source_sensor);
    scaleResolution(found->second, plan.target_sensor);
  }
  else if (condition == "noise3") {
    plan.source_sensor.noise *= 3.0;
    plan.target_sensor.noise *= 3.0;
  }
  else if (condition == "correlated") {
    correlateNoise(plan.source_sensor);
    correlateNoise(plan.target_sensor);
  }
  else if (condition == "outliers")
    addOutliers(plan.source_sensor);
  else if (condition == "lost20" || condition == "lost50") {
    plan.source_view = secondView(setup, 0.25, random);
    plan.lost_part = condition == "lost20" ? 0.2 : 0.5;
  }
  else if (condition != "same")
    refuseCondition(condition);
  return plan;
}

ScanPlan
planDrive(const CoverageSetup& setup, const std::string& condition, Random& random)
{
  const auto isOneOf = [&](const std::vector<std::string>& conditions) {
    return std::count(conditions.begin(), conditions.end(), condition) > 0;
  };
  if (!isOneOf(lidar_conditions) && !isOneOf(further_lidar_conditions))
    refuseCondition(condition);
  const bool is_sweep = condition == "lidar64_sweep";
  SensorOptions sensor = simulator::carLidar(
      condition == "lidar16" ? 16 : (condition == "lidar32" ? 32 : 64));
  if (condition == "lidar1") {
    sensor.lidar.rings = 1;
    sensor.lidar.min_elevation = sensor.lidar.max_elevation = 0.0;
    sensor.lidar.azimuth_step = 0.25;
  }
  sensor.lidar.sensor_seed = random.index(std::size_t{1} << 62);
  const DrivenViews views = drivenViews(setup, random);
  ScanPlan plan{sensor, sensor, views.source, views.target};
  if (is_sweep) {
    const Isometry3d T_target_source = sensorPose(sensor.kind, views.target).inverse() *
                                       sensorPose(sensor.kind, views.source);
    plan.sweep_motion = logSE3(T_target_source.matrix());
  }
  return plan;
}

/** \brief The value that \p part of \p values exceed. */
double
upperQuantile(Eigen::VectorXd values, double part)
{
  const auto rank =
      static_cast<Eigen::Index>(part * static_cast<double>(values.size()));
  const auto begin = values.data();
  std::nth_element(begin, begin + rank, begin + values.size(), std::greater<double>());
  return values[rank];
}

/** \brief \p target without its points beyond the plane that has \p part of \p source
 * beyond it; its normal is drawn from the plane of the first two axes of the sensor. */
Matrix3Xd
withoutLostPart(const Matrix3Xd& target,
                const Matrix3Xd& source,
                const Isometry3d& T_world_sensor,
                double part,
                Random& random)
{
  const double angle = 2.0 * 3.14159265358979323846 * random.uniform();
  const Vector3d normal =
      T_world_sensor.linear() * Vector3d(std::cos(angle), std::sin(angle), 0.0);
  const double limit = upperQuantile(source.transpose() * normal, part);
  Matrix3Xd kept(3, target.cols());
  Eigen::Index num_kept = 0;
  for (Eigen::Index i = 0; i < target.cols(); ++i)
    if (normal.dot(target.col(i)) < limit)
      kept.col(num_kept++) = target.col(i);
  return kept.leftCols(num_kept);
}

} // namespace

void
displaceSource(Random& random, CoverageCase& drawn)
{
  const Vector6d deviation = drawn.prior_sd.cwiseProduct(random.normal6());
  Vector6d turn = deviation;
  turn.head<3>().setZero();
  const Eigen::Matrix3d rotation = rotationOf(turn);
  const Vector3d shift = deviation.head<3>();
  const Vector3d centroid = drawn.source.rowwise().mean();
  // The centroid of the moved source, which the prior speaks of, is this one.
  const Vector3d moved_centroid = centroid - shift;
  drawn.source.colwise() -= centroid;
  drawn.source = (rotation.transpose() * drawn.source).eval();
  drawn.source.colwise() += moved_centroid;
  drawn.truth.linear() = rotation;
  drawn.truth.translation() = centroid - rotation * moved_centroid;
}

CoverageCase
makeCoverageCase(const std::string& scene,
                 const std::string& condition,
                 std::uint64_t seed)
{
  const CoverageSetup setup = coverageSetup(scene);
  // Cases of one seed share no random numbers.
  Random random(seed, io::hashOf(scene + '/' + condition));
  const bool is_drive = std::count(lidar_scenes.begin(), lidar_scenes.end(), scene) > 0;
  const ScanPlan plan = is_drive ? planDrive(setup, condition, random)
                                 : planScans(setup, condition, random);
  const std::uint64_t scan_seed = random.index(std::size_t{1} << 62);
  const simulator::Scene solids = simulator::makeScene(setup.simulated_scene);
  const Isometry3d target_pose = sensorPose(plan.target_sensor.kind, plan.target_view);
  const Isometry3d source_pose = sensorPose(plan.source_sensor.kind, plan.source_view);

  CoverageCase made;
  made.scene = scene;
  made.condition = condition;
  made.seed = seed;
  made.prior_sd = condition == "far" ? far_prior_sd : setup.prior_sd;
  const auto scan = [&](const SensorOptions& sensor,
                        const Isometry3d& T_world_sensor,
                        std::uint32_t scan_number) -> Matrix3Xd {
    return T_world_sensor * scanScene(solids,
                                      sensor,
                                      T_world_sensor,
                                      scan_seed,
                                      scan_number,
                                      plan.sweep_motion)
                                .points;
  };
  made.target = scan(plan.target_sensor, target_pose, 0);
  made.source = scan(plan.source_sensor, source_pose, 1);
  if (made.target.cols() == 0 || made.source.cols() == 0)
    throw std::invalid_argument("scene '" + scene +
                                "' has nothing that the sensor of '" + condition +
                                "' sees");
  if (plan.lost_part > 0.0)
    made.target =
        withoutLostPart(made.target, made.source, target_pose, plan.lost_part, random);
  displaceSource(random, made);
  return made;
}

} // namespace bayesian_icp::evaluate
