/** \file
 * \brief The parts of the report in their order: words, tables and charts.
 */
#pragma once

#include "html/page.h"
#include "register/run.h"
#include "report/chart.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief A part of the report before its charts are drawn. */
struct Section {
  std::string id;
  std::string heading;
  /** What stands above and below the charts. */
  std::string above_html;
  std::vector<Chart> charts;
  std::string below_html;
  html::FigureGrid grid = html::FigureGrid::Any;
};

/** \brief All parts below the verdict, of a run with at least one draw.
 * \param[in] command that made the run, as a shell takes it */
std::vector<Section>
reportSections(const Run& run, const std::string& command);

} // namespace bayesian_icp::app
