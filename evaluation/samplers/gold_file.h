/** \file
 * \brief The file format of gold standards, in the byte order of this machine.
 */
#pragma once

#include "samplers/gold_standard.h"

#include <iosfwd>

namespace bayesian_icp::evaluate {

/** \brief First line of the file, to be changed with the moves of the runs or the
 * energy: old files are then ignored. */
constexpr char gold_format[] = "bayesian_icp gold standard 1\n";

void
writeGold(const GoldStandard& gold, std::ostream& stream);

/** \brief Takes no more memory than three times the size of \p stream, whatever it
 * holds.
 * \throws std::runtime_error if it does not hold a whole gold standard of this version
 */
GoldStandard
readGold(std::istream& stream);

} // namespace bayesian_icp::evaluate
