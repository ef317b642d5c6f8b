/** \file
 * \brief The sub-command `trajectories`: do covariances of registrations make
 * trajectories better, and is their stated accuracy true?
 */
#pragma once

namespace bayesian_icp::evaluate {

/** \brief Run the sub-command.
 * \param[in] argc,argv the command line from the sub-command's name on
 * \return the exit code 0
 * \throws io::UsageError, io::FileError */
int
runTrajectoriesCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
