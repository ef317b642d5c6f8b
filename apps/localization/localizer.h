/** \file
 * \brief Localization of a robot: the posterior of its pose in a map, from one cloud
 * and a prior. What a node of ROS does, without ROS.
 */
#pragma once

#include "localization/stated_pose.h"
#include "register/settings.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/exports.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/point_types.h>

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief What decides the result of a Localizer. */
struct LocalizerOptions {
  /** Of the registration. Guess and prior are those of the prior that is added. */
  Settings settings;
  /** frame_id of map, priors and results. A leading / does not count, here and below.
   */
  std::string map_frame = "map";
  /** frame_id of clouds: the frame whose pose priors and results state. */
  std::string cloud_frame = "base_link";
  /** Largest difference between the stamps of cloud and prior [s]. */
  double max_prior_age = 1.0;
  PriorFloor prior_floor;

  /** \brief What is wrong with the first bad option, with its name; empty if all is
   * well. */
  std::string
  validate() const;
};

/** \brief What came of one cloud. */
struct Localization {
  /** As those of diagnostic_msgs/DiagnosticStatus. */
  enum class Level { Ok = 0, Warning = 1, Error = 2 };
  Level level = Level::Error;
  /** The level in words: Ok, what to be careful about, or why there is no posterior. */
  std::string message;
  /** Numbers for a person who looks for a reason. */
  std::vector<std::pair<std::string, std::string>> values;

  /** Pose of the cloud's frame in the map, the prior included. None with level Error.
   */
  std::optional<PoseEstimate> posterior;
  /** The same without the prior, for a filter that the prior has come from. A filter
   * does not read diagnostics, so variances are multiplied by doubt_factor with level
   * Warning, and there is none if the pose may be in another basin or conflicts with
   * the prior. */
  std::optional<PoseEstimate> measurement;
  /** Draws of the posterior, a pose in each row [m, rad]: there if `posterior` is, or
   * if there are several modes. */
  PoseMatrix draws;
};

/** \brief Add what a run says, and what is to be used of its posterior.
 * \param[in] prior of the run, with PriorFrame::Origin */
void
addEstimate(const Summary& summary,
            const PoseMatrix& draws,
            const PriorOptions& prior,
            Localization& result);

/** \brief Takes a map and priors as they come, and localizes clouds.
 *
 * setMap() and addPrior() only store, so they return at once; localize() judges what
 * they stored. These two may be called while localize() runs on another thread. The
 * result for given map, prior, cloud and settings is always the same. */
class Localizer {
public:
  /** \throws io::UsageError with options.validate() */
  explicit Localizer(const LocalizerOptions& options);

  /** \brief Take \p map in place of the map before. It is prepared once, for the next
   * cloud.
   * \param[in] map header.frame_id and points [m] */
  void
  setMap(const pcl::PCLPointCloud2::ConstPtr& map);

  /** \brief Take a prior; the last max_num_priors are kept. */
  void
  addPrior(const StatedPose& prior);

  /** \brief Sample the posterior of the pose of the cloud's frame in the map, with the
   * prior whose stamp is nearest to the cloud's.
   * \param[in] cloud header.frame_id and points [m]; those that are not finite are
   *            skipped
   * \param[in] stamp_ns the cloud's time [ns]; its header.stamp is not used, as that
   *            is in microseconds
   * \param[in] progress may return false, to cancel
   * \return level Error for bad input and for missing memory, which throw nothing */
  Localization
  localize(const pcl::PCLPointCloud2& cloud,
           std::int64_t stamp_ns,
           const ProgressCallback& progress = ProgressCallback());

  static constexpr std::size_t max_num_priors = 1000;

private:
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;

  void
  prepareMap();

  StatedPose
  priorNear(std::int64_t stamp_ns) const;

  void
  sample(const Cloud::ConstPtr& source,
         const PriorOptions& prior,
         const ProgressCallback& progress);

  LocalizerOptions options_;
  mutable std::mutex mutex_; // of the two members below it
  pcl::PCLPointCloud2::ConstPtr new_map_;
  std::deque<StatedPose> priors_;

  /** Why icp_ has no map that can be used; empty if it has one. */
  std::string map_complaint_ = "no map has arrived";
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double> icp_;
};

} // namespace bayesian_icp::app
