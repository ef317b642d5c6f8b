/** \file
 * \brief The options of the command line with their descriptions.
 */
#pragma once

#include <boost/program_options/options_description.hpp>

namespace bayesian_icp::app {

/** \brief Every option, described with its unit and its default. Values are strings. */
boost::program_options::options_description
describeOptions();

} // namespace bayesian_icp::app
