/** \file
 * \brief The options of the command line with their help texts.
 */
#pragma once

#include <boost/program_options/options_description.hpp>

namespace bayesian_icp::simulator {

/** \brief Every option takes text, which command_line.cpp turns into numbers. */
boost::program_options::options_description
allOptions();

} // namespace bayesian_icp::simulator
