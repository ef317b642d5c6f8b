#include "io/picture_numbers.h"
#include "report/charts.h"

#include <bayesian_icp/diagnostics.h>

#include <algorithm>
#include <utility>

namespace bayesian_icp::app {

namespace {

constexpr Eigen::Index max_density_draws = 4000;
constexpr Eigen::Index max_pair_draws = 400;
/** Makes each chain one of gnuplot's data sets. */
constexpr const char* data_set_separator = "\n\n";

/** \p max_rows draws of all chains in a data block of gnuplot, six columns, with
 * \p separator behind each chain. */
std::string
drawsBlock(const DrawSet& draws, Eigen::Index max_rows, const char* separator)
{
  std::string lines;
  const Eigen::Index share = std::max<Eigen::Index>(
      1, max_rows / static_cast<Eigen::Index>(draws.chains.size()));
  for (const ChainDraws& chain : draws.chains) {
    for (const Eigen::Index row : io::evenlySpaced(chain.errors.rows(), share))
      lines += plotLine(chain.errors.row(row));
    lines += separator;
  }
  return plot::dataBlock("draws", lines);
}

/** Where all but a few stray draws are, with a margin on both sides; 0 is within. */
std::pair<double, double>
rangeOf(const DrawSet& draws, int k)
{
  constexpr double stray = 0.002, margin = 0.08;
  const Eigen::VectorXd errors = pooledErrors(draws, k);
  const double low = std::min(0.0, quantile(errors, stray));
  const double high = std::max(0.0, quantile(errors, 1.0 - stray));
  const double added = high > low ? margin * (high - low) : 1.0;
  return {low - added, high + added};
}

/** Half of a range about the mean that has all of it, for each coordinate. */
Vector6d
reachesOf(const DrawSet& draws)
{
  Vector6d reaches;
  for (int k = 0; k < 6; ++k) {
    const auto [low, high] = rangeOf(draws, k);
    reaches[k] = std::max(-low, high);
  }
  return reaches;
}

std::string
intervalText(const Axis& axis)
{
  constexpr int num_digits = 3;
  const auto signedText = [](double value) {
    return (value > 0.0 ? "+" : "") + io::textOf(value, num_digits);
  };
  return "95 % from " + signedText(axis.quantile_2_5) + " to " +
         signedText(axis.quantile_97_5) + ' ' + axis.unit;
}

/** The curve in the block $density, the interval below it, and the mean. */
std::string
densityScript(const DrawSet& draws, int k)
{
  constexpr double share_of_tick = 0.2; // room for the longest numbers
  const Axis& axis = draws.axes[k];
  const double width = kernelWidth(draws, k);
  auto [low, high] = rangeOf(draws, k);
  low -= 2.0 * width;
  high += 2.0 * width;
  std::string script = drawsBlock(draws, max_density_draws, "") + chart_style +
                       "set border 1\nunset ytics\nset xlabel " +
                       plot::quotedForGnuplot(differenceLabel(axis)) + "\nset xtics " +
                       plotNumber(io::roundedUp(share_of_tick * (high - low))) +
                       "\nset yrange [0:*]\nset samples 240\nset xrange " +
                       plotRange(low, high) + '\n';
  const std::string mean_line =
      "set arrow from first 0, graph 0 to first 0, graph 1 nohead dashtype 2\n";
  if (!(width > 0.0)) // the draws are all alike
    return script + mean_line + "set yrange [0:1]\nplot NaN\n";
  const std::string colour = colouredAs(chart_colours[0]);
  return script + "set table $density\nplot $draws using " + std::to_string(k + 1) +
         ":(1) smooth kdensity bandwidth " + plotNumber(width) + "\nunset table\n" +
         mean_line + "plot $density using 1:($1 >= " + plotNumber(axis.quantile_2_5) +
         " && $1 <= " + plotNumber(axis.quantile_97_5) +
         " ? $2 : NaN) with filledcurves y1=0" + colour +
         ", $density using 1:2 with lines linewidth 2" + colour + '\n';
}

/** Places the next panel of a 6x6 grid. */
std::string
panelAt(int row, int column)
{
  constexpr double left = 0.085, bottom = 0.075, step = 0.151, size = 0.14;
  const double x = left + step * column;
  const double y = bottom + step * (5 - row);
  return placedAt(x, x + size, y, y + size);
}

/** A panel without axes that says something; darker the stronger. */
std::string
textPanel(const std::string& text, int font_size)
{
  return "unset border\nunset tics\nunset xlabel\nunset label\nset xrange [0:1]\n"
         "set yrange [0:1]\nset label 1 " +
         plot::quotedForGnuplot(text) + " at 0.5, 0.5 center font '," +
         std::to_string(font_size) + "'\nplot NaN\nunset label 1\n";
}

std::string
correlationPanel(const Matrix6d& covariance, int row, int column)
{
  const double correlation =
      covariance(row, column) /
      std::sqrt(covariance(row, row) * covariance(column, column));
  return textPanel(std::isfinite(correlation) ? io::fixedTextOf(correlation, 2) : "–",
                   std::abs(correlation) >= 0.5 ? 20 : 13);
}

/** Range, and ticks at the mean and on both sides of it.
 * \param[in] which axis of gnuplot: x or y */
std::string
axisScript(const std::string& which, double reach, bool has_labels)
{
  constexpr double share = 0.27;
  return "set " + which + "range " + plotRange(-reach, reach) + "\nset " + which +
         "tics " + plotNumber(io::roundedUp(2.0 * reach * share)) +
         (has_labels ? " format '%g' font ',10'\n" : " format ''\n");
}

std::string
scatterPanel(const DrawSet& draws, const Vector6d& reaches, int row, int column)
{
  const bool is_lowest = row == 5, is_leftmost = column == 0;
  const auto name = [&draws](int k) {
    return draws.axes[k].name + " [" + draws.axes[k].unit + ']';
  };
  const std::string script =
      "set border 15 linewidth 0.5\n" + axisScript("x", reaches[column], is_lowest) +
      axisScript("y", reaches[row], is_leftmost) +
      (is_lowest ? "set xlabel '" + name(column) + "'\n" : "unset xlabel\n") +
      (is_leftmost ? labelledAtLeft(name(row)) : "unset label\n");
  std::string plots;
  for (std::size_t i = 0; i < draws.chains.size(); ++i)
    plots += (i > 0 ? ", " : "plot ") +
             dots("$draws index " + io::textOf(i) + " using " +
                      std::to_string(column + 1) + ':' + std::to_string(row + 1),
                  2.0 * reaches[column],
                  2.2,
                  colourOf(draws.chains[i].chain));
  return script + plots + '\n';
}

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
densityChart(const DrawSet& draws, int k)
{
  const Axis& axis = draws.axes[k];
  const std::string caption =
      axis.name + ": " +
      (std::isfinite(axis.quantile_2_5) ? intervalText(axis) : "no interval");
  return {"density-" + axis.name,
          "Density of " + axis.name,
          caption,
          "Curve of the posterior density of " + axis.name +
              " about its mean, the 95 % interval filled. " + caption,
          {340, 190, densityScript(draws, k)}};
}

Chart
pairChart(const DrawSet& draws, const Matrix6d& covariance)
{
  std::string script = drawsBlock(draws, max_pair_draws, data_set_separator) +
                       chart_style + "set multiplot\n";
  const Vector6d reaches = reachesOf(draws);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      script += panelAt(row, column) +
                (column == row  ? textPanel(draws.axes[row].name, 16)
                 : column > row ? correlationPanel(covariance, row, column)
                                : scatterPanel(draws, reaches, row, column));
  const std::string caption =
      "Each pair of coordinates, as differences from the mean pose: up to " +
      io::textOf(max_pair_draws) +
      " draws, coloured by chain (a few outliers lie outside); above the diagonal, the "
      "correlations of all draws.";
  return {"pairs-of-coordinates",
          "Pairs of coordinates",
          caption,
          caption,
          {860, 860, script + "unset multiplot\n"},
          html::FigureWidth::Scrolled};
}

Chart
directionChart(const DataReport& report)
{
  const std::string caption =
      "Standard deviation along each motion of the table: disc, in the posterior; "
      "circle, in the prior. Where they meet, the clouds add no information.";
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
