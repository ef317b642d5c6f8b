/** \file
 * \brief Puts a scene, or a registration as it runs, into a window.
 */
#pragma once

#include "viewer/legend.h"
#include "viewer/scene.h"
#include "viewer/window.h"

#include <string>

namespace bayesian_icp::app {
struct Run;
}

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

/** \brief Register the clouds of \p run in a thread of its own and show it in \p window
 * until it is done, the user closes the window, or there is a SIGINT; off-screen, draw
 * its last state only.
 * \param[in] scene clouds and guess of the run */
void
registerLive(const Scene& scene,
             const ViewOptions& options,
             Window& window,
             app::Run& run);

} // namespace bayesian_icp::viewer
