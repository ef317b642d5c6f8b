/** \file
 * \brief Shows ICP and the chains as they run.
 */
#pragma once

#include "register/run.h"
#include "viewer/live_state.h"
#include "viewer/scene.h"
#include "viewer/window.h"

namespace bayesian_icp::viewer {

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
