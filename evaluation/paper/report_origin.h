/** \file
 * \brief How a report was made, and how to make it again.
 */
#pragma once

#include "paper/paper_options.h"
#include "paper/report_document.h"

namespace bayesian_icp::evaluate {

/** \brief The command line with every option, versions of what took part, and the
 * machine. */
ReportSection
originSection(const PaperOptions& options);

} // namespace bayesian_icp::evaluate
