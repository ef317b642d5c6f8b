/** \file
 * \brief Registers the scans of a track, one after the other.
 */
#pragma once

#include "track/track.h"
#include "track/track_request.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/prepared_target.h>

#include <map>
#include <memory>
#include <optional>

namespace bayesian_icp::app {

/** \brief The motion before the scans are seen: the velocity is that of the guess, as
 * uncertain as its prior. */
MotionModel
motionModelOf(const TrackRequest& request);

/** \brief Reads clouds, and registers each to the target of a Track. It keeps the
 * points of the target and of the scans that the next target will have. */
class Tracker {
public:
  /** \param[in] request,track must outlive this object */
  Tracker(const TrackRequest& request, const Track& track);
  ~Tracker();

  /** \brief Register the next scan of the track, which has to take the step then. A
   * scan that cannot be read is one that cannot be registered.
   * \param[in] progress returns false to cancel
   * \return nothing if that was cancelled
   * \throws io::FileError if a scan of the target cannot be read */
  std::optional<TrackStep>
  registerNext(const ProgressCallback& progress);

private:
  void
  prepareTarget();

  /** What came of a registration. */
  struct Attempt {
    TrackStep step;
    /** The more the better; Useless: the step has no edge, and its message says why. */
    enum Quality { Useless, Contradiction, Doubtful, Good } quality = Useless;
  };

  Attempt
  registerTo(const Eigen::Matrix3Xd& points,
             bool is_velocity_doubted,
             const ProgressCallback& progress) const;

  /** With the prediction; if that is not good, as if the velocity were unknown. */
  Attempt
  registerTo(const Eigen::Matrix3Xd& points, const ProgressCallback& progress) const;

  const TrackRequest& request_;
  const Track& track_;
  /** Of scans that the target consists of now or next [m], by their numbers. */
  std::map<int, Eigen::Matrix3Xd> points_;
  /** The scan in whose frame target_points_ are; -1 before the first one. */
  int prepared_target_ = -1;
  std::unique_ptr<PreparedTarget> target_points_;
};

} // namespace bayesian_icp::app
