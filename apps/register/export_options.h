/** \file
 * \brief The options of pcl_bayesian_icp that concern exports.
 */
#pragma once

#include "register/export_files.h"

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/variables_map.hpp>

namespace bayesian_icp::app {

/** \brief They fill \p exports, which has to outlive them. */
boost::program_options::options_description
describeExportOptions(ExportRequest& exports);

/** \throws io::UsageError if there is an option that has no effect because --export is
 *         missing */
void
refuseExportOptionsWithoutExport(const boost::program_options::variables_map& given);

} // namespace bayesian_icp::app
