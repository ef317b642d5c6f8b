/** \file
 * \brief The parameters of a node.
 */
#pragma once

#include "localization/localizer.h"

#include <map>
#include <string>

namespace bayesian_icp::app {

/** \brief Options from parameters of a node. docs/ros1.md lists those of the node. All
 * others are options of pcl_bayesian_icp, with _ in place of each -, but not those of
 * guess and prior, which arrive as messages.
 * \param[in] parameters texts by their names: numbers, names, "true" or "false", or
 *            numbers with commas between them
 * \throws io::UsageError or io::FileError (config) with the parameter or option */
LocalizerOptions
readParameters(const std::map<std::string, std::string>& parameters);

} // namespace bayesian_icp::app
