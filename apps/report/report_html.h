/** \file
 * \brief The report of a run as one HTML page.
 */
#pragma once

#include "register/run.h"
#include "report/section.h"

#include <string>

namespace bayesian_icp::app {

/** \brief A self-contained page: verdict, tables, charts, and what is needed to repeat
 * the run. The charts are drawn by gnuplot.
 * \param[in] run with at least one draw
 * \param[in] command that made the run, as a shell takes it
 * \throws plot::GnuplotError if gnuplot cannot draw */
std::string
reportHtml(const Run& run, const std::string& command);

} // namespace bayesian_icp::app
