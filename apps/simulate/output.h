/** \file
 * \brief Writes a simulated pair to a folder.
 */
#pragma once

#include "simulator/simulation.h"

#include <string>

namespace bayesian_icp::simulator {

/** \brief Write source.pcd, target.pcd, T_target_source.txt and scene.json.
 *
 * Each file is written under a temporary name and renamed when all are complete: a name
 * never holds half a file.
 * \param[in] folder made if missing
 * \throws std::runtime_error naming the file and the reason; no temporary file is left
 */
void
writePair(const std::string& folder,
          const SimulationOptions& options,
          const ScanPair& pair);

} // namespace bayesian_icp::simulator
