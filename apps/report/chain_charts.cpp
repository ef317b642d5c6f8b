#include "report/charts.h"

#include <algorithm>

namespace bayesian_icp::app {

namespace {

/** Of all chains together, in one trace. */
constexpr Eigen::Index max_trace_draws = 1200;
/** Traces with fewer draws have a dot for each. */
constexpr Eigen::Index max_marked_draws = 60;
constexpr int max_rank_bins = 20;
/** Draws a bin and chain, so that the noise of a bin stays below a third or so. */
constexpr Eigen::Index min_draws_a_bin = 10;

std::string
blockName(const char* kind, std::size_t i)
{
  return kind + std::to_string(i);
}

/** Lines "index of the draw, difference from the mean". */
std::string
traceBlock(const std::string& name,
           const Eigen::VectorXd& errors,
           Eigen::Index max_rows)
{
  std::string lines;
  for (const Eigen::Index row : evenlySpaced(errors.size(), max_rows))
    lines += std::to_string(row) + ' ' + plotNumber(errors[row]) + '\n';
  return plot::dataBlock(name, lines);
}

/** Lines "lower edge of the bin in percent of all ranks, draws in it in units of what
 * is expected". */
std::string
rankBlock(const std::string& name,
          const Eigen::VectorXd& ranks,
          double num_ranks,
          int num_bins)
{
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(num_bins);
  for (const double rank : ranks)
    counts[std::min(num_bins - 1,
                    static_cast<int>(num_bins * (rank + 0.5) / num_ranks))] += 1.0;
  const double expected = static_cast<double>(ranks.size()) / num_bins;
  std::string lines;
  for (int bin = 0; bin <= num_bins; ++bin)
    lines += plotNumber(100.0 * bin / num_bins) + ' ' +
             plotNumber(counts[std::min(bin, num_bins - 1)] / expected) + '\n';
  return plot::dataBlock(name, lines);
}

std::string
dataBlocks(const DrawSet& draws, int k)
{
  const auto num_chains = static_cast<Eigen::Index>(draws.chains.size());
  const std::vector<Eigen::VectorXd> ranks = ranksOf(draws, k);
  Eigen::Index num_ranks = 0, shortest = ranks.front().size();
  for (const Eigen::VectorXd& of_chain : ranks) {
    num_ranks += of_chain.size();
    shortest = std::min(shortest, of_chain.size());
  }
  const int num_bins = static_cast<int>(
      std::clamp<Eigen::Index>(shortest / min_draws_a_bin, 2, max_rank_bins));
  std::string blocks;
  for (std::size_t i = 0; i < draws.chains.size(); ++i)
    blocks +=
        traceBlock(blockName("trace", i),
                   draws.chains[i].errors.col(k),
                   std::max<Eigen::Index>(20, max_trace_draws / num_chains)) +
        rankBlock(
            blockName("ranks", i), ranks[i], static_cast<double>(num_ranks), num_bins);
  return blocks;
}

std::string
linesOf(const DrawSet& draws, const char* kind, const std::string& style)
{
  std::string lines;
  for (std::size_t i = 0; i < draws.chains.size(); ++i)
    lines += (i > 0 ? ", $" : "$") + blockName(kind, i) + " using 1:2 with " + style +
             " linecolor rgb '" + colourOf(draws.chains[i].chain) + '\'';
  return lines;
}

/** Two panels: the traces, and below them the ranks. */
std::string
chainScript(const DrawSet& draws, int k)
{
  const Axis& axis = draws.axes[static_cast<std::size_t>(k)];
  Eigen::Index last_draw = 1;
  for (const ChainDraws& chain : draws.chains)
    last_draw = std::max(last_draw, chain.errors.rows() - 1);
  const bool is_short = last_draw < max_marked_draws;
  return dataBlocks(draws, k) + chart_style +
         "set multiplot\nset lmargin at screen 0.22\nset rmargin at screen 0.96\n"
         "set bmargin at screen 0.6\nset tmargin at screen 0.97\n"
         "set xlabel 'draw of the chain' offset 0, 0.4\nset xtics " +
         plotNumber(std::max(1.0, roundStep(static_cast<double>(last_draw), 0.2))) +
         "\nset xrange [0:" + std::to_string(last_draw) +
         "]\nset ylabel offset 0.6, 0 " +
         plot::quotedForGnuplot(axis.name + " − mean [" + axis.unit + ']') + "\nplot " +
         linesOf(draws,
                 "trace",
                 is_short ? "linespoints pointtype 7 pointsize 0.2 linewidth 0.6"
                          : "lines linewidth 0.6") +
         "\nset bmargin at screen 0.15\nset tmargin at screen 0.43\n"
         "set xlabel 'rank among all draws [%]'\nset ylabel 'draws / expected'\n"
         "set xrange [0:100]\nset xtics 20\nset yrange [0:*]\nset ytics 1\n"
         "plot 1 with lines linecolor rgb '" +
         quiet_colour + "' dashtype 2, " +
         linesOf(draws, "ranks", "steps linewidth 1.4") + "\nunset multiplot\n";
}

Chart
chainChart(const DrawSet& draws, int k)
{
  const std::string& name = draws.axes[static_cast<std::size_t>(k)].name;
  Chart chart;
  chart.id = "chains-" + name;
  chart.title = "Chains of " + name;
  chart.caption = name + ": trace, and ranks.";
  chart.description =
      "Above, the draws of " + name +
      " in their order, one line for each chain; below, how often each chain "
      "has the ranks among all draws, in units of what is expected.";
  chart.drawing = {340, 350, 12, chainScript(draws, k)};
  return chart;
}

} // namespace

std::vector<Chart>
chainCharts(const DrawSet& draws)
{
  std::vector<Chart> charts(6);
  for (std::size_t k = 0; k < charts.size(); ++k)
    charts[k] = chainChart(draws, static_cast<int>(k));
  return charts;
}

} // namespace bayesian_icp::app
