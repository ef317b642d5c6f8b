/** \file
 * \brief Gold standards on disk, so that one is made once for the same inputs.
 */
#pragma once

#include "samplers/sampler_problem.h"

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief Write a gold standard, in the byte order of this machine. */
void
writeGold(const GoldStandard& gold, std::ostream& stream);

/** \brief Takes no more memory than three times the size of \p stream, whatever it
 * holds.
 * \throws std::runtime_error if it does not hold a whole gold standard of this version
 */
GoldStandard
readGold(std::istream& stream);

/** \brief What a gold standard depends on, in one number: points, likelihood, prior,
 * options of its runs. The number of threads and of seconds are left out. */
std::uint64_t
goldKey(const Problem& problem, const GoldOptions& options);

/** \brief Read the gold standard of \p problem from \p folder, or make it and write it
 * there. One that had not converged is made again if more time is allowed now. Its
 * draws are poses theta, not canonical (angles within half a turn).
 * \param[in] report gets a line now and then
 * \throws io::FileError if the folder cannot be written */
GoldStandard
cachedGold(const Problem& problem,
           const GoldOptions& options,
           const std::string& folder,
           const std::function<void(const std::string&)>& report);

} // namespace bayesian_icp::evaluate
