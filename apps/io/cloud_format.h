/** \file
 * \brief Checks of cloud files before PCL reads them. PCL's readers believe the header:
 * they allocate what it claims, and read past the end of what is not there.
 */
#pragma once

#include "io/input_file.h"

#include <cstdint>

namespace bayesian_icp::io {

/** \brief Check that a PCD file is well formed and as long as its header says.
 * \return number of points, positive
 * \throws FileError with the reason */
std::uint64_t
checkPcd(InputFile& file);

/** \brief Check that a PLY file is well formed and as long as its header says.
 * \return number of points, positive
 * \throws FileError with the reason */
std::uint64_t
checkPly(InputFile& file);

} // namespace bayesian_icp::io
