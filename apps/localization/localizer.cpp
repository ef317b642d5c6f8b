#include "localization/localizer.h"

#include "graph/pose_graph.h"
#include "io/clocks.h"
#include "io/errors.h"
#include "io/field_triple.h"
#include "io/numbers.h"
#include "io/time_stamps.h"
#include "register/configure.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/summary.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>

namespace bayesian_icp::app {

namespace {

/** ROS 1 had frames with a leading slash, ROS 2 has none. */
std::string
withoutSlash(const std::string& frame)
{
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

void
requireFrame(const std::string& what,
             const std::string& frame,
             const std::string& expected)
{
  if (withoutSlash(frame) != withoutSlash(expected))
    throw Refusal("the " + what + "'s frame_id is " + io::inQuotes(frame) +
                  ", but must be " + io::inQuotes(expected));
}

/** \param[in] what the cloud's name in complaints */
pcl::PointCloud<pcl::PointXYZ>::Ptr
pointsOf(const pcl::PCLPointCloud2& message, const std::string& what)
{
  const std::size_t num_points = std::size_t(message.width) * message.height;
  const std::string the_cloud = "the " + what + " ";
  if (num_points == 0)
    throw Refusal(the_cloud + "has no points");
  if (message.is_bigendian != 0)
    throw Refusal(the_cloud + "has is_bigendian set, which is not supported");
  // A product of the three could overflow.
  if (message.point_step == 0 || message.data.size() % message.point_step != 0 ||
      message.data.size() / message.point_step != num_points)
    throw Refusal(the_cloud + "has " + std::to_string(message.data.size()) +
                  " bytes of data, but should have " + std::to_string(num_points) +
                  " points of " + std::to_string(message.point_step) + " bytes");
  const io::FieldTriple xyz(message, {"x", "y", "z"});
  if (!xyz.isComplete())
    throw Refusal(the_cloud + "has no floating-point fields x, y and z");
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    const Eigen::Vector3f point = xyz.get(message, i).cast<float>();
    if (point.allFinite())
      cloud->push_back({point[0], point[1], point[2]});
  }
  if (cloud->empty())
    throw Refusal(the_cloud + "has no finite points");
  return cloud;
}

std::string
shortly(double number)
{
  return io::textOf(number, 4);
}

/** Standard deviations of the covariance that is published. */
void
addDeviations(const PoseEstimate& estimate, Localization& result)
{
  static constexpr std::array<const char*, 6> keys = {
      "x [m]", "y [m]", "z [m]", "about x [rad]", "about y [rad]", "about z [rad]"};
  const Matrix6d& covariance = estimate.covariance(CovarianceConvention::R3xSO3);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    result.values.emplace_back(std::string("standard deviation ") + keys[k],
                               shortly(std::sqrt(covariance(i, i))));
  }
}

void
addSummary(const Summary& summary, Localization& result)
{
  double rhat = summary.coordinates[0].rhat, ess = summary.coordinates[0].bulk_ess;
  for (const CoordinateSummary& coordinate : summary.coordinates) {
    rhat = std::max(rhat, coordinate.rhat);
    ess = std::min({ess, coordinate.bulk_ess, coordinate.tail_ess});
  }
  result.values.emplace_back("status", toString(summary.status));
  result.values.emplace_back("draws", std::to_string(summary.num_draws));
  result.values.emplace_back("largest R-hat", shortly(rhat));
  result.values.emplace_back("least effective sample size", shortly(ess));
  result.values.emplace_back("modes",
                             std::to_string(std::max<std::size_t>(
                                 summary.modes.size(), summary.num_draws > 0)));
  if (!summary.data.is_available)
    return;
  result.values.emplace_back("share of points on the map",
                             shortly(summary.data.active_fraction));
  result.values.emplace_back("noise [m]", shortly(summary.data.noise_scale));
}

} // namespace

void
addEstimate(const Summary& summary,
            const PoseMatrix& draws,
            const PriorOptions& prior,
            Localization& result)
{
  result.message = summary.message;
  addSummary(summary, result);
  const PoseEstimate posterior(summary);
  const std::string complaint = complaintAboutExport(posterior, false);
  if (summary.status == Status::SeveralModes)
    result.draws = draws;
  if (!complaint.empty())
    return;
  PoseMeasurement measurement =
      withoutPrior(posterior, Prior(prior.mean, prior.variance));
  const bool is_ok = summary.status == Status::Ok;
  result.level = is_ok ? Localization::Level::Ok : Localization::Level::Warning;
  result.posterior = posterior;
  const DataFlags& flags = summary.data.flags;
  if (!flags.mayBeInAnotherBasin() && !flags.prior_conflict &&
      complaintAboutExport(measurement.estimate, false).empty()) {
    for (Matrix6d& covariance : measurement.estimate.covariances)
      covariance *= is_ok ? 1.0 : doubt_factor;
    result.measurement = measurement.estimate;
  }
  result.draws = draws;
  addDeviations(posterior, result);
  result.values.emplace_back("directions that the prior alone holds",
                             std::to_string(measurement.num_unmeasured));
}

std::string
LocalizerOptions::validate() const
{
  if (withoutSlash(map_frame).empty() || withoutSlash(cloud_frame).empty())
    return "map_frame and cloud_frame must not be empty";
  if (!(max_prior_age >= 0.0))
    return "max_prior_age is " + io::textOf(max_prior_age) +
           ", but must not be negative (s)";
  for (const double floor : {prior_floor.translation, prior_floor.rotation})
    if (!(floor >= 0.0) || !std::isfinite(floor))
      return "a floor of the prior is " + io::textOf(floor) +
             ", but must be finite and not negative (m, rad)";
  if (settings.isNormalized() || settings.are_lengths_scaled ||
      settings.is_step_size_times_points || settings.is_effective_points_source_size)
    return "settings must not be in units of a cloud's size or number of points";
  return settings.validate();
}

Localizer::Localizer(const LocalizerOptions& options) : options_(options)
{
  const std::string complaint = options.validate();
  if (!complaint.empty())
    throw io::UsageError(complaint);
  configure(options_.settings, icp_);
  // Nothing here needs ICP, which does not run then.
  icp_.setUseMeanAsFinalTransformation(true);
}

void
Localizer::setMap(const pcl::PCLPointCloud2::ConstPtr& map)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  new_map_ = map;
}

void
Localizer::addPrior(const StatedPose& prior)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  priors_.push_back(prior);
  if (priors_.size() > max_num_priors)
    priors_.pop_front();
}

void
Localizer::prepareMap()
{
  pcl::PCLPointCloud2::ConstPtr map;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    map.swap(new_map_);
  }
  if (map) {
    map_complaint_ = "the map was not accepted";
    try {
      requireFrame("map", map->header.frame_id, options_.map_frame);
      icp_.setInputTarget(pointsOf(*map, "map"));
      map_complaint_.clear();
    }
    catch (const Refusal& refusal) {
      map_complaint_ = refusal.what();
    }
  }
  if (!map_complaint_.empty())
    throw Refusal(map_complaint_);
}

StatedPose
Localizer::priorNear(std::int64_t stamp_ns) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (priors_.empty())
    throw Refusal("no prior has arrived");
  const auto distance = [stamp_ns](const StatedPose& prior) {
    return std::abs(io::secondsOf(prior.stamp_ns - stamp_ns));
  };
  // Of equally near ones the last, which may be a correction.
  const auto nearest = std::min_element(
      priors_.rbegin(), priors_.rend(), [&](const StatedPose& a, const StatedPose& b) {
        return distance(a) < distance(b);
      });
  return *nearest;
}

void
Localizer::sample(const Cloud::ConstPtr& source,
                  const PriorOptions& prior,
                  const ProgressCallback& progress)
{
  Options options = options_.settings.options;
  options.prior = prior;
  icp_.setOptions(options);
  icp_.setProgressCallback(progress);
  icp_.setInputSource(source);
  Cloud moved_source;
  icp_.align(moved_source, matrixOf(prior.mean));
}

Localization
Localizer::localize(const pcl::PCLPointCloud2& cloud,
                    std::int64_t stamp_ns,
                    const ProgressCallback& progress)
{
  const double start = io::wallSeconds();
  Localization result;
  try {
    prepareMap();
    requireFrame("cloud", cloud.header.frame_id, options_.cloud_frame);
    const Cloud::Ptr source = pointsOf(cloud, "cloud");
    result.values.emplace_back("finite points", std::to_string(source->size()));
    const StatedPose stated = priorNear(stamp_ns);
    const double age = io::secondsOf(stamp_ns - stated.stamp_ns);
    result.values.emplace_back("prior's age [s]", shortly(age));
    if (std::abs(age) > options_.max_prior_age)
      throw Refusal("no prior is near enough in time: the nearest is " +
                    shortly(std::abs(age)) + (age > 0.0 ? " s older" : " s newer") +
                    " than the cloud, but max_prior_age is " +
                    shortly(options_.max_prior_age) + " s");
    requireFrame("prior", stated.frame, options_.map_frame);
    const StatedPrior prior = priorFrom(stated, options_.prior_floor);
    result.values.emplace_back("factor of the prior's variances for its correlations",
                               shortly(prior.widening));
    sample(source, prior.options, progress);
    addEstimate(icp_.getSummary(), icp_.getSamples(), prior.options, result);
  }
  catch (const Refusal& refusal) {
    result.message = refusal.what();
  }
  catch (const std::bad_alloc&) {
    result = Localization();
    result.message = "out of memory";
  }
  result.values.emplace_back("time [s]", shortly(io::wallSeconds() - start));
  return result;
}

} // namespace bayesian_icp::app
