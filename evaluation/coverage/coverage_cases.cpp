#include "coverage/coverage_cases.h"

#include "io/coordinates.h"
#include "io/text_hash.h"
#include "study/named.h"

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

/** \brief What a camera's image looks like. */
struct Image {
  int width;
  int height;
  /** Horizontal field of view [rad]. */
  double field_of_view;
};

CoverageSetup
depthCamera(const Image& image, const View& view)
{
  CoverageSetup setup;
  setup.sensor.camera.width = image.width;
  setup.sensor.camera.height = image.height;
  setup.sensor.camera.horizontal_fov = image.field_of_view * app::degrees_per_radian;
  setup.sensor.jitter = 1.0;
  setup.sensor.min_range = 0.2;
  setup.sensor.max_range = 8.0;
  setup.view = view;
  setup.prior_sd = AxisDeviation{0.03, 0.06}.vector();
  return setup;
}

/** \brief A camera with twice the noise, which grows as surfaces turn away. */
CoverageSetup
timeOfFlightCamera(const Image& image, const View& view)
{
  CoverageSetup setup = depthCamera(image, view);
  setup.sensor.noise = 2.0;
  setup.sensor.incidence_noise = 1.0;
  return setup;
}

CoverageSetup
carriedOn(const Vector3d& step, CoverageSetup setup)
{
  setup.step = step;
  return setup;
}

CoverageSetup
lidar(double min_elevation, double max_elevation, const View& view)
{
  CoverageSetup setup;
  setup.sensor.kind = SensorKind::Lidar;
  setup.sensor.lidar.rings = 32;
  setup.sensor.lidar.min_elevation = min_elevation;
  setup.sensor.lidar.max_elevation = max_elevation;
  setup.sensor.lidar.azimuth_step = 0.8;
  setup.sensor.jitter = 1.0;
  setup.sensor.max_range = 12.0;
  setup.view = view;
  setup.step = {0.6, 0.15, 0.1};
  setup.prior_sd = AxisDeviation{0.1, 0.03}.vector();
  return setup;
}

/** \brief The view with an object's origin, the middle of its height, moved to there
 * from its foot. */
View
fromFoot(double height, const View& view)
{
  const Vector3d middle(0.0, 0.0, 0.5 * height);
  return {view.eye - middle, view.look_at - middle};
}

struct NamedSetup {
  std::string name;
  CoverageSetup setup;
};

using Setups = std::vector<NamedSetup>;

const Setups&
tunedSetups()
{
  const Vector3d eye(0.0, -0.8, 0.5);
  const Vector3d object(0.0, 0.0, 0.05);
  const CoverageSetup table = depthCamera({128, 96, 1.0}, {eye, Vector3d::Zero()});
  static const Setups setups = {
      {"bowl", depthCamera({112, 112, 0.36}, fromFoot(0.076, {eye, object}))},
      {"can", depthCamera({112, 112, 0.22}, fromFoot(0.12, {eye, object}))},
      {"mug",
       depthCamera({112, 112, 0.22}, fromFoot(0.10, {{0.25, -0.76, 0.5}, object}))},
      {"table_top", table},
      {"plain_corridor",
       carriedOn({0.6, 0.15, 0.1},
                 depthCamera({128, 96, 1.0}, {{0.0, 0.0, 1.2}, {5.0, 0.1, 1.0}}))},
      {"table", table}};
  return setups;
}

const Setups&
newSetups()
{
  static const Setups setups = {
      {"cube", depthCamera({96, 96, 0.3}, {{0.3, -0.75, 0.5}, {0.0, 0.0, 0.05}})},
      {"bracket", depthCamera({96, 96, 0.22}, {{0.25, -0.7, 0.45}, {0.0, 0.0, 0.03}})},
      {"carton",
       timeOfFlightCamera({96, 96, 0.36}, {{0.3, -0.75, 0.6}, {0.0, 0.0, 0.05}})},
      {"tool", depthCamera({96, 96, 0.26}, {{0.3, -0.65, 0.45}, {0.0, 0.0, 0.02}})},
      {"box",
       timeOfFlightCamera({96, 96, 0.32}, {{0.4, -0.7, 0.45}, {0.0, 0.0, 0.07}})},
      {"stairs",
       carriedOn(
           {0.25, 0.1, 0.05},
           timeOfFlightCamera({96, 96, 0.9}, {{-1.3, 0.0, 1.4}, {0.6, 0.0, 0.4}}))},
      {"room", lidar(-30.0, 10.0, {{0.0, 0.0, 1.2}, {1.0, 0.0, 1.2}})},
      {"car", lidar(-25.0, 0.0, {{-3.5, -3.0, 1.8}, {-2.5, -2.0, 1.8}})},
      {"tree", lidar(-25.0, 15.0, {{-3.0, -1.0, 1.8}, {-2.0, -0.7, 1.8}})},
      {"ground", lidar(-30.0, 0.0, {{0.0, 0.0, 1.8}, {1.0, 0.0, 1.8}})}};
  return setups;
}

CoverageSetup
makeLidarSetup(const std::string& scene)
{
  const simulator::SimulationOptions usual = simulator::defaultOptions(scene);
  CoverageSetup setup;
  setup.sensor = usual.sensor;
  setup.view = usual.target_view;
  setup.prior_sd = AxisDeviation{0.3, 0.03}.vector();
  return setup;
}

/** \throws std::invalid_argument if there is no such scene */
CoverageSetup
findSetup(const std::string& scene)
{
  for (const Setups* setups : {&tunedSetups(), &newSetups()})
    if (const NamedSetup* const found = findNamed(*setups, scene))
      return found->setup;
  if (std::count(lidar_scenes.begin(), lidar_scenes.end(), scene) > 0)
    return makeLidarSetup(scene);
  throw std::invalid_argument("the coverage study has no scene '" + scene + "'");
}

Vector3d
turnedAboutVertical(const Vector3d& vector, double angle)
{
  return Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * vector;
}

/** A second view: 10 to 20 degrees around the object to a side chosen at random and up
 * to 0.08 m up or down, or CoverageSetup::step on and turned by 0.2 rad. \param[in]
 * scale factor on all of that */
View
secondView(const CoverageSetup& setup, double scale, Random& random)
{
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
  const double angle = 0.17 + 0.18 * random.uniform();
  const double rise = 0.08 * (2.0 * random.uniform() - 1.0);
  const Vector3d forward = setup.view.look_at - setup.view.eye;
  if (setup.step.isZero()) {
    const Vector3d turned = turnedAboutVertical(-forward, scale * side * angle);
    return {setup.view.look_at + turned + scale * rise * Vector3d::UnitZ(),
            setup.view.look_at};
  }
  const Vector3d eye = setup.view.eye + scale * setup.step;
  return {eye, eye + turnedAboutVertical(forward, scale * side * 0.2)};
}

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

std::vector<std::string>
tunedScenes()
{
  return namesOf(tunedSetups());
}

std::vector<std::string>
newScenes()
{
  return namesOf(newSetups());
}

CoverageSetup
coverageSetup(const std::string& scene)
{
  CoverageSetup setup = findSetup(scene);
  // The study's table top has its edges in view.
  setup.simulated_scene = scene == "table_top" ? "table_plate" : scene;
  return setup;
}

DrivenViews
drivenViews(const CoverageSetup& setup, Random& random)
{
  const double start = 8.0 * (2.0 * random.uniform() - 1.0);
  const double heading = 0.05 * (2.0 * random.uniform() - 1.0);
  const double way = 0.5 + 1.5 * random.uniform();
  const double turn = 0.07 * (2.0 * random.uniform() - 1.0);
  const Vector3d forward = setup.view.look_at - setup.view.eye;
  const Vector3d eye = setup.view.eye + start * forward;
  // The chord of an arc points half of its turn aside.
  const Vector3d next = eye + way * turnedAboutVertical(forward, heading + 0.5 * turn);
  return {{eye, eye + turnedAboutVertical(forward, heading)},
          {next, next + turnedAboutVertical(forward, heading + turn)}};
}

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
