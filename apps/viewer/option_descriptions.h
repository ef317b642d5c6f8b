/** \file
 * \brief The viewer's options with their descriptions.
 */
#pragma once

#include <boost/program_options/options_description.hpp>

#include <string>

namespace bayesian_icp::viewer {

/** \brief Every option, the registration's included. Those that may be given once a
 * cloud are lists of strings, the others strings. */
boost::program_options::options_description
describeOptions();

/** \brief Our own keys; pcl_viewer prints its keys itself. */
std::string
keysText();

} // namespace bayesian_icp::viewer
