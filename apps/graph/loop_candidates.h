/** \file
 * \brief Where a trajectory comes back to where it was.
 */
#pragma once

#include "graph/pose_graph.h"

#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief For each pose the nearest earlier one within \p radius, if in between the
 * trajectory was more than twice the radius away. Near neighbours in the sequence are
 * no loops by that.
 * \param[in] radius [m]
 * \return pairs (earlier, later), in the order of the later ones */
std::vector<std::pair<int, int>>
loopCandidates(const std::vector<GaussianPose>& poses, double radius);

} // namespace bayesian_icp::app
