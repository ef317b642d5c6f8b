/** \file
 * \brief One registration of a sequence, as an edge.
 */
#pragma once

#include "track/track.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/prepared_cloud.h>

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
 * \param[in] source the scan; its points are finite [m]
 * \param[in] target another scan, or a map [m]
 * \param[in] options with a prior about the sensor
 * \param[in] progress returns false to cancel; may be empty */
Registration
registered(const PreparedCloud& source,
           const PreparedCloud& target,
           const Options& options,
           const ProgressCallback& progress);

} // namespace bayesian_icp::app
