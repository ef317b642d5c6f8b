/** \file
 * \brief SGD-ICP of two files.
 */
#pragma once

#include "register/command_line.h"

namespace bayesian_icp::app {

/** \brief Register by SGD-ICP and report as asked.
 * \return the exit code: 0 if the descent came to rest, 1 if not, 130 if interrupted
 * \throws io::FileError for clouds and results */
int
runSgdIcp(const Request& request);

} // namespace bayesian_icp::app
