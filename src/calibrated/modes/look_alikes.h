/** \file
 * \brief Places that look alike: what the sensors could not see at each of them.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"
#include "calibrated/score/surface_score.h"

#include <vector>

namespace bayesian_icp {

/** \brief For each mode and point, in the order of SurfaceScores: whether the point
 * fits nowhere, and the other cloud's sensor could not see it from there. It may be
 * hidden behind other points, beyond the sensor's range or between its rays.
 *
 * Empty if this cannot be told, or is not needed: if a cloud is not a scan around the
 * origin of its frame, if one cloud is a part of the other, or if the modes differ by
 * rotations as well. */
std::vector<std::vector<char>>
unseenPoints(const SurfaceScorer& scorer, const std::vector<CalibratedMode>& modes);

} // namespace bayesian_icp
