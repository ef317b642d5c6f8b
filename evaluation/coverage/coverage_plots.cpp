#include "coverage/coverage_plots.h"

#include "coverage/coverage_summary.h"
#include "coverage/coverage_table.h"

#include <io/errors.h>
#include <io/numbers.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <array>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_bins = 10;
constexpr std::array<const char*, 6> coordinates = {"vx", "vy", "vz", "wx", "wy", "wz"};

using Runs = std::vector<CoverageRun>;

Runs
validOf(const Runs& runs)
{
  Runs valid;
  std::copy_if(runs.begin(),
               runs.end(),
               std::back_inserter(valid),
               [](const auto& run) { return run.score.is_valid; });
  return valid;
}

/** Empirical distribution function of the smallest region that has the truth. */
std::string
coverageData(const Runs& runs)
{
  std::vector<double> regions;
  for (const CoverageRun& run : runs)
    regions.push_back(run.score.region);
  std::sort(regions.begin(), regions.end());
  std::string lines = "0 0\n";
  for (std::size_t i = 0; i < regions.size(); ++i)
    lines +=
        io::textOf(regions[i]) + ' ' +
        io::textOf(static_cast<double>(i + 1) / static_cast<double>(regions.size())) +
        '\n';
  return lines + "1 1\n";
}

/** Lines "middle of the bin, density of each coordinate". */
std::string
pitData(const Runs& runs)
{
  Eigen::Matrix<double, num_bins, 6> counts;
  counts.setZero();
  for (const CoverageRun& run : runs)
    for (int k = 0; k < 6; ++k)
      counts(std::min(num_bins - 1, static_cast<int>(num_bins * run.score.pit[k])),
             k) += 1.0;
  std::string lines;
  for (int bin = 0; bin < num_bins; ++bin) {
    lines += io::textOf((bin + 0.5) / num_bins);
    for (int k = 0; k < 6; ++k)
      lines += ' ' +
               io::textOf(counts(bin, k) * num_bins / static_cast<double>(runs.size()));
    lines += '\n';
  }
  return lines;
}

using Methods = std::vector<std::pair<std::string, Runs>>;

template <typename Data>
std::string
blocksOf(const std::string& prefix, const Methods& methods, const Data& data)
{
  std::string blocks;
  for (std::size_t i = 0; i < methods.size(); ++i)
    blocks += plot::dataBlock(prefix + std::to_string(i), data(methods[i].second));
  return blocks;
}

std::string
coverageScript(const Methods& methods)
{
  std::string plot = "plot x notitle with lines linecolor 'gray'";
  for (std::size_t i = 0; i < methods.size(); ++i)
    plot += ", $coverage" + std::to_string(i) +
            " using 1:2 with steps linewidth 2 title " +
            plot::quotedForGnuplot(methods[i].first);
  return blocksOf("coverage", methods, coverageData) +
         "reset\nset key outside right\nset grid\nset xrange [0:1]\nset yrange [0:1]\n"
         "set size ratio -1\n"
         "set xlabel 'probability of the region'\n"
         "set ylabel 'share of truths within it'\n" +
         plot::pictures("900, 600", plot + "\n");
}

std::string
pitScript(const Methods& methods)
{
  const std::string rows = std::to_string(methods.size());
  std::string plot = "set multiplot layout " + rows + ", 6\n";
  for (std::size_t i = 0; i < methods.size(); ++i)
    for (std::size_t k = 0; k < coordinates.size(); ++k)
      plot += "set title " +
              plot::quotedForGnuplot(methods[i].first + ' ' + coordinates[k]) +
              "\nplot $pit" + std::to_string(i) + " using 1:" + std::to_string(k + 2) +
              " with boxes, 1 linecolor 'gray'\n";
  return blocksOf("pit", methods, pitData) +
         "reset\nunset key\nset style fill solid 0.6 noborder\nset boxwidth 0.09\n"
         "set xrange [0:1]\nset yrange [0:*]\nset xtics 0.5\n" +
         plot::pictures("1200, " + std::to_string(180 * methods.size()),
                        plot + "unset multiplot\n");
}

/** Lines "index of the cell, ANEES"; the same cells for every method. */
std::string
aneesData(const Runs& runs, const std::vector<std::string>& cells)
{
  std::vector<Runs> of_cell(cells.size());
  for (const CoverageRun& run : runs) {
    const auto cell = std::find(
        cells.begin(), cells.end(), run.name.scene + ' ' + run.name.condition);
    of_cell[static_cast<std::size_t>(cell - cells.begin())].push_back(run);
  }
  std::string lines;
  for (std::size_t i = 0; i < cells.size(); ++i)
    lines += std::to_string(i) + ' ' + io::textOf(summaryOf(of_cell[i]).anees) + '\n';
  return lines;
}

std::string
aneesScript(const Runs& runs, const Methods& methods)
{
  std::vector<std::string> cells;
  for (const CoverageRun& run : runs) {
    const std::string cell = run.name.scene + ' ' + run.name.condition;
    if (std::find(cells.begin(), cells.end(), cell) == cells.end())
      cells.push_back(cell);
  }
  std::string ticks, plot = "plot 1 notitle with lines linecolor 'gray'";
  for (std::size_t i = 0; i < cells.size(); ++i)
    ticks += (i > 0 ? ", " : "") + plot::quotedForGnuplot(cells[i]) + ' ' +
             std::to_string(i);
  for (std::size_t i = 0; i < methods.size(); ++i)
    plot += ", $anees" + std::to_string(i) + " using 1:2 with points pointtype " +
            std::to_string(i + 4) + " title " +
            plot::quotedForGnuplot(methods[i].first);
  const auto data = [&cells](const Runs& of_method) {
    return aneesData(of_method, cells);
  };
  return blocksOf("anees", methods, data) +
         "reset\nset key outside right\nset grid\nset logscale y\n"
         "set ylabel 'mean NEES / 6'\nset xrange [-0.5:" +
         std::to_string(cells.size()) + " - 0.5]\nset xtics rotate by -60 (" + ticks +
         ")\n" +
         plot::pictures(
             std::to_string(std::max<std::size_t>(900, 300 + 18 * cells.size())) +
                 ", 600",
             plot + "\n");
}

} // namespace

void
plotCoverage(const Runs& runs, const std::string& folder)
{
  Methods methods;
  for (const auto& [name, of_method] : runsByMethod(runs))
    if (const Runs valid = validOf(of_method); !valid.empty())
      methods.emplace_back(name, valid);
  if (methods.empty())
    throw io::FileError(folder, "no plots: there is no valid run");
  plot::savePictures("set encoding utf8\n" + coverageScript(methods) +
                         pitScript(methods) + aneesScript(runs, methods),
                     {"coverage", "pit", "anees"},
                     folder);
}

} // namespace bayesian_icp::evaluate
