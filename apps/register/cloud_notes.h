/** \file
 * \brief Notes about clouds that are likely not what they should be.
 */
#pragma once

#include "io/cloud_file.h"
#include "register/settings.h"

#include <string>

namespace bayesian_icp::app {

/** \brief Where a cloud is larger than any LiDAR scan, and the default prior the only
 * one: its rotation moves such points hundreds of times as far as its translation.
 * Empty if all is plausible. */
std::string
noteOfSize(const io::CloudFile& cloud, const Settings& settings);

/** \brief Where many points are at the sensor: drivers put returns without a range
 * there. Empty otherwise. */
std::string
noteOfZeros(const io::CloudFile& cloud);

/** \brief Print these notes, and that of lost digits, about the first scan of many,
 * unless it cannot be read. */
void
tellNotesOfFirst(const std::string& scan, const Settings& settings);

} // namespace bayesian_icp::app
