/** \file
 * \brief The files that -o asks for.
 */
#pragma once

#include "io/output_folder.h"
#include "register/run.h"

#include <iosfwd>

namespace bayesian_icp::app {

/** \brief The draws of the chains that have not diverged: a header with units, then a
 * line a draw with 17 significant digits, chains and draws counted from 0. */
void
writeSamples(const std::vector<Chain>& chains, std::ostream& stream);

/** \brief Put samples.csv and posterior.json on their way into \p folder.
 * \throws io::FileError if one cannot be written */
void
addPosteriorFiles(const Run& run, io::OutputFolder& folder);

} // namespace bayesian_icp::app
