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
    lines +=
        std::to_string(i + 1) + ' ' +
        plotNumber(millimetres_per_metre * directions[i].standard_deviation) + ' ' +
        plotNumber(millimetres_per_metre * directions[i].prior_standard_deviation) +
        '\n';
  return plot::dataBlock("directions", lines);
}

} // namespace

Chart
directionChart(const DataReport& report)
{
  Chart chart;
  chart.id = "directions";
  chart.title = "Standard deviation along each motion";
  chart.caption = "Standard deviation along each motion of the table: disc, in the "
                  "posterior; circle, in the prior. Where they meet the clouds say "
                  "nothing.";
  chart.description = chart.caption;
  const std::string posterior =
      std::string("linecolor rgb '") + chart_colours[0] + '\'';
  const std::string prior = std::string("linecolor rgb '") + chart_colours[1] + '\'';
  chart.drawing = {
      420,
      200,
      12,
      directionsBlock(report.directions) + chart_style +
          "set logscale x\nset format x '%g'\nset grid xtics linewidth 0.3\n"
          "set yrange [6.6:0.4]\nset ytics 1\nset ylabel 'motion'\n"
          "set xlabel 'standard deviation of the points [mm]'\n"
          "set offsets graph 0.04, graph 0.04, 0, 0\n"
          "plot $directions using 2:1:($3 - $2):(0) with vectors nohead linewidth 2 "
          "linecolor rgb '" +
          quiet_colour +
          "', $directions using 3:1 with points pointtype 6 pointsize 0.7 linewidth "
          "2 " +
          prior + ", $directions using 2:1 with points pointtype 7 pointsize 0.6 " +
          posterior + '\n'};
  return chart;
}

} // namespace bayesian_icp::app
