/** \file
 * \brief One registration of a sequence, as an edge.
 */
#pragma once

#include "track/track.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/prepared_target.h>

#include <string>

namespace bayesian_icp::app {

/** \brief How good a registration is; the better, the later. */
enum class Quality { Cancelled, Useless, Contradiction, Doubtful, Good };

/** \brief What came of a registration. */
struct Registration {
  Quality quality = Quality::Useless;
  /** Short name of the Status. */
  std::string status;
  /** Also why it is useless. */
  std::string message;
  /** Of the clouds alone; widened by doubt_factor if that is doubtful. */
  TrackEdge edge;
};

/** \brief Register a scan.
 * \param[in] points of the scan, 3 x n, finite [m]
 * \param[in] options with a prior about the sensor
 * \param[in] progress returns false to cancel; may be empty */
Registration
registered(const Eigen::Matrix3Xd& points,
           const PreparedTarget& target,
           const Options& options,
           const ProgressCallback& progress);

} // namespace bayesian_icp::app
