/** \file
 * \brief A track as files for other software.
 */
#pragma once

#include "track/track.h"

#include <string>

namespace bayesian_icp::app {

/** \brief TUM trajectory: a line of each scan, its pose in the frame of scan 0. */
std::string
tumText(const Track& track);

/** \brief The covariances of tumText(), in CovarianceConvention::R3xSO3. */
std::string
tumCovarianceText(const Track& track);

/** \brief Vertices, FIX 0, and the edges of each step, without the prior; those of
 * predicted and split steps are the prediction. */
std::string
g2oText(const Track& track);

} // namespace bayesian_icp::app
