/** \file
 * \brief Gold standards on disk, so that one is made once for the same inputs.
 */
#pragma once

#include "samplers/sampler_problem.h"

#include <functional>
#include <string>

namespace bayesian_icp::evaluate {

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

/** \brief What tells rows of this gold standard from rows of others: a hash of what it
 * depends on, and the draws themselves of one that has not converged, which may become
 * another one. */
std::string
rowKey(const Problem& problem, const GoldOptions& options, const GoldStandard& gold);

} // namespace bayesian_icp::evaluate
