/** \file
 * \brief The options of the command line with their descriptions.
 */
#pragma once

#include <boost/program_options/options_description.hpp>

namespace bayesian_icp::app {

struct Settings;

/** \brief Add the options that decide the result of a registration, which all programs
 * that register have in common, described with their units and \p defaults. Values are
 * strings. Each preset has a group, so that an option can be there several times. */
void
describeSettings(const Settings& defaults,
                 boost::program_options::options_description& options);

/** \brief Every option of pcl_bayesian_icp, described with its unit and its default.
 * Values are strings. */
boost::program_options::options_description
describeOptions();

} // namespace bayesian_icp::app
