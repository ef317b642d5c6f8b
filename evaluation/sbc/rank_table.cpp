#include "sbc/rank_table.h"

#include "io/coordinates.h"
#include "study/formatted_text.h"

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

} // namespace bayesian_icp::evaluate
