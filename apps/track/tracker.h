/** \file
 * \brief Registers the scans of a track, one after the other.
 */
#pragma once

#include "register/settings.h"
#include "track/registration.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/prepared_cloud.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief Everything that decides the result of a track. */
struct TrackRequest {
  /** Files of the scans, in their order. */
  std::vector<std::string> scans;
  /** When each was taken [ns]; increasing. */
  std::vector<std::int64_t> times;
  /** Guess and prior are those of the motion from scan 0 to scan 1. */
  Settings settings;
  /** Standard deviations of the motion model [m/s^2, rad/s^2]. */
  double acceleration = 5.0;
  double angular_acceleration = 5.0;
  /** Each scan is registered to so many scans before it; the filter takes the edge to
   * its target only. */
  int span = 1;
  /** Width of the voxels that keep one point of a map [m]; 0: the target is one scan.
   */
  double voxel_size = 0.0;
  /** Scans that make a map. */
  int map_scans = 5;

  /** \brief io::stateOf() scan 0, in whose frame all poses are, and another scan. */
  std::string
  filesState(int scan) const;
};

/** \brief The motion before scans are registered: the velocity is that of the guess, as
 * uncertain as its prior. If scan 0 lies in a plane, the sensor moves in this plane.
 * \throws io::FileError if scan 0 cannot be read */
MotionModel
motionModelOf(const TrackRequest& request);

/** \brief Reads clouds, and registers each to the target of a Track. It keeps the
 * target, the last scans, and the points that the next map will have. */
class Tracker {
public:
  /** \param[in] request,track must outlive this object */
  Tracker(const TrackRequest& request, const Track& track);

  /** \brief Register the next scan of the track, which has to take the step then. A
   * scan that cannot be read is one that cannot be registered.
   * \param[in] progress returns false to cancel
   * \return nothing if that was cancelled
   * \throws io::FileError if a scan of the target cannot be read */
  std::optional<TrackStep>
  registerNext(const ProgressCallback& progress);

private:
  /** The scan's finite points, read if they are not at hand. */
  PreparedCloud
  preparedScan(int scan);

  PreparedCloud
  mapOfTarget();

  void
  prepareTarget();

  /** The prior is the prediction; if that is not good, it is tried again as if the
   * velocity were unknown.
   * \param[out] is_velocity_doubted whether the second try is the result */
  Registration
  registerToTarget(const PreparedCloud& source,
                   const ProgressCallback& progress,
                   bool& is_velocity_doubted) const;

  /** To scans before the target, from where \p step puts the scan. Those that cannot be
   * registered are left out. \return false if it was cancelled */
  bool
  registerToMore(const PreparedCloud& source,
                 const ProgressCallback& progress,
                 TrackStep& step);

  const TrackRequest& request_;
  const Track& track_;
  /** Points of scans that the next map will have [m], by their numbers. */
  std::map<int, Eigen::Matrix3Xd> thinned_;
  /** The last scans, each from when it is first needed: the source of one registration
   * is the target of the next. */
  std::map<int, PreparedCloud> prepared_;
  /** The scan in whose frame target_ is; -1 before the first one. */
  int target_scan_ = -1;
  std::optional<PreparedCloud> target_;
};

} // namespace bayesian_icp::app
