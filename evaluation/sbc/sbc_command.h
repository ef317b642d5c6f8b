/** \file
 * \brief The sub-command `sbc`: simulation-based calibration of the samplers.
 */
#pragma once

namespace bayesian_icp::evaluate {

/** \brief Run the sub-command.
 * \param[in] argc,argv the command line from the sub-command's name on
 * \return the exit code 0, or 1 if the ranks of a well-specified model are not uniform
 * \throws io::UsageError, io::FileError */
int
runSbcCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
