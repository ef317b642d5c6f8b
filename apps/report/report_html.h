/** \file
 * \brief The report of a run as one HTML page.
 */
#pragma once

#include "register/run.h"
#include "report/sections.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief A self-contained page: verdict, tables, charts, and what is needed to repeat
 * the run. The charts are drawn by gnuplot.
 * \param[in] run with at least one draw
 * \param[in] command that made the run, as a shell takes it
 * \throws plot::GnuplotError if gnuplot cannot draw */
std::string
reportHtml(const Run& run, const std::string& command);

/** \brief Parts of such a page, with their charts drawn.
 * \throws plot::GnuplotError if gnuplot cannot draw */
std::string
sectionsHtml(const std::vector<Section>& sections);

} // namespace bayesian_icp::app
