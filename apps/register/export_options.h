/** \file
 * \brief The options of pcl_bayesian_icp that concern exports.
 */
#pragma once

#include "register/export_files.h"

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/variables_map.hpp>

namespace bayesian_icp::app {

boost::program_options::options_description
describeExportOptions();

/** \brief What the command line says of exports; without formats if nothing.
 * \throws io::UsageError if a value is malformed, or an option has no effect */
ExportRequest
readExportOptions(const boost::program_options::variables_map& given);

} // namespace bayesian_icp::app
