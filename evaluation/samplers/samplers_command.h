/** \file
 * \brief The sub-command `samplers`: every sampler on every scene and cell, next to a
 * gold standard.
 */
#pragma once

namespace bayesian_icp::evaluate {

/** \brief Run the sub-command.
 * \param[in] argc,argv the command line from the sub-command's name on
 * \return the exit code 0, or 1 if a gold standard did not converge
 * \throws io::UsageError, io::FileError */
int
runSamplersCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
