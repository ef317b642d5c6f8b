/** \file
 * \brief The viewer's keys, in addition to those of pcl_viewer.
 */
#pragma once

#include <string>

namespace bayesian_icp::viewer {

class Window;

/** \brief What they are; pcl_viewer prints its keys itself. */
std::string
keysText();

/** \brief From now on keys switch layers and the legend; h prints them, and lets PCL
 * print its own. */
void
handleKeys(Window& window);

} // namespace bayesian_icp::viewer
