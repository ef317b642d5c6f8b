/** \file
 * \brief Simulated recordings.
 */
#pragma once

#include "study/recordings.h"

namespace bayesian_icp::evaluate {

/** \brief Names of the simulated drives: a car with a spinning LiDAR of 32 rings in a
 * street; a robot with one of 16 rings around a block of corridors, and to and fro on a
 * floor of offices; a depth camera that is carried around in a room. All but the street
 * come back to where they have been. */
std::vector<std::string>
driveNames();

/** \brief A simulated drive. Scans are of one instant each, ten per second.
 * \param[in] seed of the noise
 * \param[in] num_scans on the whole way, at least 2
 * \throws std::invalid_argument if there is no drive of this name */
Recording
makeDrive(const std::string& name, std::uint64_t seed, std::size_t num_scans);

} // namespace bayesian_icp::evaluate
