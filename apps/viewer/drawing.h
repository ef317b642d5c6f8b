/** \file
 * \brief Puts a scene into a window.
 */
#pragma once

#include "viewer/legend.h"
#include "viewer/scene.h"
#include "viewer/window.h"

#include <string>

namespace bayesian_icp::viewer {

/** \brief Add points of one colour under the name \p id. */
void
addPoints(const Eigen::Matrix3Xd& points,
          const PointStyle& style,
          const std::string& id,
          int viewport,
          Window& window);

/** \brief Draw all panels of the options; layers that need draws are left out if there
 * are none. Names of what belongs to a layer begin with the layer's. */
void
drawScene(const Scene& scene, const ViewOptions& options, Window& window);

} // namespace bayesian_icp::viewer
