/** \file
 * \brief A chart of the report before it is drawn, and what all charts have in common.
 */
#pragma once

#include "html/page.h"
#include "io/numbers.h"
#include "plot/gnuplot.h"

#include <array>
#include <cmath>
#include <initializer_list>
#include <string>

namespace bayesian_icp::app {

/** \brief A picture to be drawn, with the words that go with it. */
struct Chart {
  /** Unique in the page: letters, digits and '-'. */
  std::string id;
  std::string title;
  std::string caption;
  /** What there is to see, for those who cannot. */
  std::string description;
  plot::Drawing drawing;
  html::FigureWidth width = html::FigureWidth::Small;
};

/** \brief Colours that colour-blind readers can tell apart (Okabe and Ito 2008, and two
 * more), on white and on black. */
inline constexpr std::array<const char*, 8> chart_colours = {"#0072B2",
                                                             "#D55E00",
                                                             "#009E73",
                                                             "#CC79A7",
                                                             "#E69F00",
                                                             "#56B4E9",
                                                             "#999933",
                                                             "#AA4466"};
inline constexpr const char* target_colour = chart_colours[0];
inline constexpr const char* source_colour = chart_colours[1];
inline constexpr const char* quiet_colour = "#8A939C";

/** \brief The colour of a chain; the ninth has that of the first. */
inline const char*
colourOf(int chain)
{
  return chart_colours[static_cast<std::size_t>(chain) % chart_colours.size()];
}

/** \brief A number as gnuplot reads it, with the digits that a picture shows. */
inline std::string
plotNumber(double value)
{
  constexpr int num_digits = 7;
  return std::isfinite(value) ? io::textOf(value, num_digits) : "NaN";
}

/** \brief A line of numbers with spaces between. */
template <typename Numbers = std::initializer_list<double>>
std::string
plotLine(const Numbers& numbers)
{
  std::string line;
  for (const double number : numbers)
    line += (line.empty() ? "" : " ") + plotNumber(number);
  return line + '\n';
}

/** \brief "[low:high]" */
inline std::string
plotRange(double low, double high)
{
  return '[' + plotNumber(low) + ':' + plotNumber(high) + ']';
}

/** \brief The style that all charts begin with: thin axes without a box. */
inline constexpr const char* chart_style = "unset key\nset border 3 linewidth 0.8\n"
                                           "set tics nomirror scale 0.5\n"
                                           "set style fill transparent solid 0.3\n";

/** \brief Settings that place the next plot; borders as parts of the whole picture. */
inline std::string
placedAt(double left, double right, double bottom, double top)
{
  return "set lmargin at screen " + plotNumber(left) + "\nset rmargin at screen " +
         plotNumber(right) + "\nset bmargin at screen " + plotNumber(bottom) +
         "\nset tmargin at screen " + plotNumber(top) + '\n';
}

/** \brief The name of the next plots' y axis, at the left edge of the picture. gnuplot
 * leaves out a `ylabel` for which long tick labels leave no place. */
inline std::string
labelledAtLeft(const std::string& name)
{
  return "set label 99 " + plot::quotedForGnuplot(name) +
         " at screen 0.02, graph 0.5 center rotate\n";
}

/** \brief The colour of what is plotted. */
inline std::string
colouredAs(const std::string& colour)
{
  return " linecolor rgb '" + colour + '\'';
}

/** \brief Faint dots at what \p data names ("$block using 1:2"): strokes a thousandth
 * of the x range long with round ends, a third of the bytes of gnuplot's points. */
inline std::string
dots(const std::string& data, double x_span, double size, const std::string& colour)
{
  return data + ":(" + plotNumber(1e-3 * x_span) +
         "):(0) with vectors nohead linewidth " + plotNumber(size) +
         colouredAs("#30" + colour.substr(1));
}

} // namespace bayesian_icp::app
