/** \file
 * \brief The record next to the clouds, from which they can be made again.
 */
#pragma once

#include "simulator/simulation.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace bayesian_icp::simulator {

/** \brief A command line, without the output folder, that spells out every option and
 * so makes the same pair even if a default changes. */
std::string
fullCommandLine(const SimulationOptions& options);

/** \brief The content of scene.json: full command line, options, frames, transforms. */
nlohmann::ordered_json
recordOf(const SimulationOptions& options, const ScanPair& pair);

} // namespace bayesian_icp::simulator
