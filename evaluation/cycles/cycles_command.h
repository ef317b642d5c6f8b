/** \file
 * \brief The sub-command `cycles`: are the covariances of a pose graph's edges right,
 * judged without the truth?
 */
#pragma once

namespace bayesian_icp::evaluate {

/** \brief Run the sub-command.
 * \param[in] argc,argv the command line from the sub-command's name on
 * \return the exit code 0, or 1 if the errors of the closures are larger than chance
 * allows
 * \throws io::UsageError, io::FileError */
int
runCyclesCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
