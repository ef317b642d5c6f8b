/** \file
 * \brief What a summary says about modes.
 */
#pragma once

#include "sampler/chain_set.h"

#include <bayesian_icp/summary.h>

#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief The modes of \p chain_set that have draws, heaviest first. */
std::vector<Mode>
summarizeModes(const ChainSet& chain_set);

/** \brief How many modes, and their weights, in words. */
std::string
modesMessage(const Summary& summary);

/** \brief Addition to a message if chains were moved to a better mode, or empty. */
std::string
movedMessage(const ChainSet& chain_set);

} // namespace bayesian_icp
