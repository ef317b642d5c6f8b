/** \file
 * \brief The parts of a report: words, tables and charts.
 */
#pragma once

#include "html/page.h"
#include "io/output_folder.h"
#include "report/chart.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief A part of the report before its charts are drawn. */
struct Section {
  std::string id;
  std::string heading;
  /** What stands above and below the charts. */
  std::string above_html;
  std::vector<Chart> charts = {};
  std::string below_html = {};
  html::FigureGrid grid = html::FigureGrid::Any;
};

/** \brief A command, and in which folder it was given: the current one.
 * \param[in] note what else is to be said before it */
std::string
commandHtml(const std::string& command, const std::string& note = "");

/** \brief The parts with their charts drawn.
 * \throws plot::GnuplotError if gnuplot cannot draw */
std::string
sectionsHtml(const std::vector<Section>& sections);

/** \brief Put report.html on its way into \p folder. What keeps it from being drawn
 * keeps nothing else from being written: it is told on standard error, and there is no
 * report.
 * \param[in] make returns the page */
void
addReport(const std::function<std::string()>& make, io::OutputFolder& folder);

} // namespace bayesian_icp::app
