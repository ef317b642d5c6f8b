#include "sbc/rank_table.h"

#include "formatted_text.h"

#include <io/coordinates.h>
#include <io/folders.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace {

std::string
verdictOf(const RankSampler& sampler, bool is_uniform)
{
  if (!sampler.is_well_specified)
    return "no model of the scans: for information";
  return is_uniform ? "uniform" : "NOT UNIFORM";
}

/** Lines "bin, runs in it". */
std::string
histogramLines(const RankHistogram& histogram)
{
  std::string lines;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin)
    lines += std::to_string(bin) + ' ' + std::to_string(histogram[bin]) + '\n';
  return lines;
}

} // namespace

bool
printRankTable(const RankStudy& study, const RankFile& results, std::ostream& stream)
{
  stream << "                        valid  chi-square of 10 bins, uniform if below "
         << max_rank_chi_square << " (0.1 %)\n  sampler               /runs";
  for (const char* name : app::coordinate_names)
    stream << format("%8s", name);
  stream << '\n';
  bool are_all_uniform = true;
  for (const RankSampler& sampler : study.samplers) {
    const std::vector<Ranks> runs = ranksOfSampler(study, sampler, results);
    stream << format(
        "  %-17s %5zu/%-5d", sampler.name.c_str(), runs.size(), study.num_runs);
    bool is_uniform = runs.size() == static_cast<std::size_t>(study.num_runs);
    for (int k = 0; k < 6; ++k) {
      const double statistic =
          runs.empty() ? std::nan("") : chiSquareOf(rankHistogram(runs, k));
      is_uniform = is_uniform && statistic < max_rank_chi_square;
      stream << format("%8.1f", statistic);
    }
    stream << "  " << verdictOf(sampler, is_uniform) << '\n';
    are_all_uniform = are_all_uniform && (is_uniform || !sampler.is_well_specified);
  }
  return are_all_uniform;
}

void
plotRanks(const RankStudy& study, const RankFile& results, const std::string& folder)
{
  const std::size_t num_rows = study.samplers.size();
  std::string data;
  std::string plot = "set multiplot layout " + std::to_string(num_rows) + ", 6\n";
  for (std::size_t i = 0; i < num_rows; ++i) {
    const RankSampler& sampler = study.samplers[i];
    const std::vector<Ranks> runs = ranksOfSampler(study, sampler, results);
    const double expected = static_cast<double>(runs.size()) / num_rank_bins;
    for (int k = 0; k < 6; ++k) {
      const std::string name = "ranks" + std::to_string(i) + '_' + std::to_string(k);
      data += plot::dataBlock(name, histogramLines(rankHistogram(runs, k)));
      plot +=
          "set title " +
          plot::quotedForGnuplot(sampler.name + ' ' +
                                 app::coordinate_names[static_cast<std::size_t>(k)]) +
          "\nplot $" + name + " using 1:2 with boxes, " + format("%.1f", expected) +
          " linecolor 'gray'\n";
    }
  }
  plot::savePictures("set encoding utf8\n" + data +
                         "reset\nunset key\nset style fill solid 0.6 noborder\n"
                         "set boxwidth 0.9\nset xrange [-0.5:9.5]\nset yrange [0:*]\n" +
                         plot::pictures("1200, " + std::to_string(180 * num_rows),
                                        plot + "unset multiplot\n"),
                     {"ranks"},
                     folder);
}

} // namespace bayesian_icp::evaluate
