/** \file
 * \brief The viewer's keys, in addition to those of pcl_viewer.
 */
#pragma once

#include "viewer/window.h"

namespace bayesian_icp::viewer {

/** \brief From now on keys switch layers and the legend; h prints them, and lets PCL
 * print its own. */
void
handleKeys(Window& window);

} // namespace bayesian_icp::viewer
