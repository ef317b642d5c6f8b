#include "io/picture_numbers.h"
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

/** Lines "index of the draw, difference from the mean". */
std::string
traceBlock(const std::string& name,
           const Eigen::VectorXd& errors,
           Eigen::Index max_rows)
{
  std::string lines;
  for (const Eigen::Index row : io::evenlySpaced(errors.size(), max_rows))
    lines += plotLine({static_cast<double>(row), errors[row]});
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
    lines += plotLine(
        {100.0 * bin / num_bins, counts[std::min(bin, num_bins - 1)] / expected});
  return plot::dataBlock(name, lines);
}

/** Two panels: the traces, and below them the ranks. */
std::string
chainScript(const DrawSet& draws, int k)
{
  const Axis& axis = draws.axes[k];
  const std::vector<Eigen::VectorXd> ranks = ranksOf(draws, k);
  Eigen::Index num_draws = 0, shortest = ranks.front().size(), longest = 2;
  for (const Eigen::VectorXd& of_chain : ranks) {
    num_draws += of_chain.size();
    shortest = std::min(shortest, of_chain.size());
    longest = std::max(longest, of_chain.size());
  }
  const int num_bins = static_cast<int>(
      std::clamp<Eigen::Index>(shortest / min_draws_a_bin, 2, max_rank_bins));
  const Eigen::Index max_rows = std::max<Eigen::Index>(
      20, max_trace_draws / static_cast<Eigen::Index>(ranks.size()));
  const std::string trace_style =
      longest <= max_marked_draws
          ? " with linespoints pointtype 7 pointsize 0.2 linewidth 0.6"
          : " with lines linewidth 0.6";
  std::string blocks, trace_plots, rank_plots;
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    const std::string colour = colouredAs(colourOf(draws.chains[i].chain));
    const std::string trace = "trace" + std::to_string(i);
    const std::string rank = "ranks" + std::to_string(i);
    blocks += traceBlock(trace, draws.chains[i].errors.col(k), max_rows) +
              rankBlock(rank, ranks[i], static_cast<double>(num_draws), num_bins);
    trace_plots += (i > 0 ? ", $" : "$") + trace + " using 1:2" + trace_style + colour;
    rank_plots += ", $" + rank + " using 1:2 with steps linewidth 1.4" + colour;
  }
  return blocks + chart_style + "set multiplot\n" + placedAt(0.22, 0.96, 0.6, 0.97) +
         "set xlabel 'draw of the chain' offset 0, 0.4\nset xtics " +
         plotNumber(
             std::max(1.0, io::roundedUp(0.2 * static_cast<double>(longest - 1)))) +
         "\nset xrange [0:" + std::to_string(longest - 1) + "]\n" +
         labelledAtLeft(differenceLabel(axis)) + "plot " + trace_plots + '\n' +
         placedAt(0.22, 0.96, 0.15, 0.43) + labelledAtLeft("draws / expected") +
         "set xlabel 'rank among all draws [%]'\n"
         "set xrange [0:100]\nset xtics 20\nset yrange [0:*]\nset ytics 1\n"
         "plot 1 with lines" +
         colouredAs(quiet_colour) + " dashtype 2" + rank_plots + "\nunset multiplot\n";
}

} // namespace

Chart
chainChart(const DrawSet& draws, int k)
{
  const std::string& name = draws.axes[k].name;
  return {"chains-" + name,
          "Chains of " + name,
          name + ": trace, and ranks.",
          "Above, the draws of " + name +
              " in their order, one line for each chain; below, how often each chain "
              "has the ranks among all draws, in units of the expected number.",
          {340, 350, chainScript(draws, k)}};
}

} // namespace bayesian_icp::app
