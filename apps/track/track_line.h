/** \file
 * \brief The line of JSON that a scan of a track ends in.
 */
#pragma once

#include "track/tracker.h"

#include <string>

namespace bayesian_icp::app {

/** \brief The line of the last step of \p track, without a line break. It has all that
 * Track::take() needs, to the last bit. */
std::string
trackLine(const TrackRequest& request, const Track& track);

/** \brief Read a line back.
 * \param[in] scan that the line has to be of
 * \throws std::runtime_error with the reason if it is not a line of that scan, made
 *         with the same settings */
TrackStep
readTrackLine(const std::string& line, const TrackRequest& request, int scan);

} // namespace bayesian_icp::app
