#include "report/charts.h"

#include <vector>

namespace bayesian_icp::app {

namespace {

constexpr double millimetres_per_metre = 1e3;

/** Lines "number, posterior, prior [mm]". */
std::string
directionsBlock(const std::vector<DataDirection>& directions)
{
  std::string lines;
  for (std::size_t i = 0; i < directions.size(); ++i)
    lines += plotLine({static_cast<double>(i + 1),
                       millimetres_per_metre * directions[i].standard_deviation,
                       millimetres_per_metre * directions[i].prior_standard_deviation});
  return plot::dataBlock("directions", lines);
}

} // namespace

Chart
directionChart(const DataReport& report)
{
  const std::string caption =
      "Standard deviation along each motion of the table: disc, in the posterior; "
      "circle, in the prior. Where they meet the clouds say nothing.";
  const std::string script =
      directionsBlock(report.directions) + chart_style +
      "set logscale x\nset format x '%g'\nset grid xtics linewidth 0.3\n"
      "set yrange [6.6:0.4]\nset ytics 1\nset ylabel 'motion'\n"
      "set xlabel 'standard deviation of the points [mm]'\n"
      "set offsets graph 0.04, graph 0.04, 0, 0\n"
      "plot $directions using 2:1:($3 - $2):(0) with vectors nohead linewidth 2" +
      colouredAs(quiet_colour) +
      ", $directions using 3:1 with points pointtype 6 pointsize 0.7 linewidth 2" +
      colouredAs(chart_colours[1]) +
      ", $directions using 2:1 with points pointtype 7 pointsize 0.6" +
      colouredAs(chart_colours[0]) + '\n';
  return {"directions",
          "Standard deviation along each motion",
          caption,
          caption,
          {420, 200, script}};
}

} // namespace bayesian_icp::app
