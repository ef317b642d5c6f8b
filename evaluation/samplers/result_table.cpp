#include "samplers/result_table.h"

#include "study/draw_statistics.h"
#include "study/formatted_text.h"

#include <algorithm>
#include <map>
#include <ostream>
#include <tuple>

namespace bayesian_icp::evaluate {

namespace {

/** Kolmogorov-Smirnov distance below which a marginal counts as right. */
constexpr double good_ks = 0.06;

using CellName = std::tuple<std::string, double, double>;
using Scores = std::vector<Score>;

template <typename Number>
std::vector<double>
collect(const Scores& scores, const Number& number)
{
  std::vector<double> values;
  for (const Score& score : scores)
    values.push_back(number(score));
  return values;
}

double
largest(const std::vector<double>& values)
{
  return *std::max_element(values.begin(), values.end());
}

double
smallest(const std::vector<double>& values)
{
  return *std::min_element(values.begin(), values.end());
}

double
medianCoordinateKl(const Scores& scores)
{
  std::vector<double> values;
  for (const Score& score : scores)
    values.insert(values.end(), score.coordinate_kl.begin(), score.coordinate_kl.end());
  return median(values);
}

double
shareOfGoodMarginals(const Scores& scores)
{
  double num_good = 0.0;
  for (const Score& score : scores)
    num_good +=
        static_cast<double>((score.kolmogorov_smirnov.array() < good_ks).count());
  return num_good / (6.0 * static_cast<double>(scores.size()));
}

void
printHeader(std::ostream& stream)
{
  stream
      << "                                             6-D KL          1-D KL  W1     "
         "KS<.06  R-hat  bulk ESS  tail ESS     ESS/s  CPU [s] mixed\n"
         "scene      sigma  N     sampler        runs  median   worst  median  median "
         "     %  worst  smallest  smallest    median   median  runs\n";
}

/** At most \p precision digits after the point, right-justified. */
std::string
column(double value, int width, int precision)
{
  return format(" %*.*f", width - 1, precision, value);
}

void
printLine(const CellName& cell,
          const std::string& sampler,
          const Scores& scores,
          std::ostream& stream)
{
  const auto kl = collect(scores, [](const Score& s) { return s.kl; });
  const auto seconds = collect(scores, [](const Score& s) { return s.seconds; });
  const auto rate = collect(scores, [](const Score& s) { return s.essPerSecond(); });
  const auto rhat = collect(scores, [](const Score& s) { return s.rhat; });
  const auto bulk = collect(scores, [](const Score& s) { return s.bulk_ess; });
  const auto tail = collect(scores, [](const Score& s) { return s.tail_ess; });
  const auto w1 =
      collect(scores, [](const Score& s) { return s.wasserstein.maxCoeff(); });
  const auto num_mixed = std::count_if(
      scores.begin(), scores.end(), [](const Score& s) { return s.status == "ok"; });
  stream << format("%-10s %-6g %-5g %-16s %2zu",
                   std::get<0>(cell).c_str(),
                   std::get<1>(cell),
                   std::get<2>(cell),
                   sampler.c_str(),
                   scores.size())
         << column(median(kl), 8, 4) << column(largest(kl), 8, 4)
         << column(medianCoordinateKl(scores), 8, 4) << column(median(w1), 8, 3)
         << column(100.0 * shareOfGoodMarginals(scores), 7, 0)
         << column(largest(rhat), 7, 3) << column(smallest(bulk), 10, 0)
         << column(smallest(tail), 10, 0) << column(median(rate), 10, 1)
         << column(median(seconds), 9, 3)
         << column(static_cast<double>(num_mixed), 6, 0) << '\n';
}

/** "paper" of "paper 1e-05". */
std::string
familyOf(const std::string& sampler)
{
  return sampler.substr(0, sampler.find(' '));
}

void
printCell(const CellName& cell,
          const std::map<std::string, Scores>& samplers,
          std::ostream& stream)
{
  std::map<std::string, std::size_t> most_runs;
  for (const auto& [sampler, scores] : samplers) {
    std::size_t& most = most_runs[familyOf(sampler)];
    most = std::max(most, scores.size());
  }
  for (const auto& [sampler, scores] : samplers)
    if (scores.size() == most_runs[familyOf(sampler)])
      printLine(cell, sampler, scores, stream);
}

} // namespace

void
printTable(const std::vector<ScoredRun>& runs, std::ostream& stream)
{
  std::map<CellName, std::map<std::string, Scores>> cells;
  for (const ScoredRun& run : runs)
    cells[{run.name.scene, run.name.sigma, run.name.effective_points}][run.name.sampler]
        .push_back(run.score);
  printHeader(stream);
  for (const auto& [cell, samplers] : cells)
    printCell(cell, samplers, stream);
}

} // namespace bayesian_icp::evaluate
