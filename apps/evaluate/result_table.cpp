#include "result_table.h"

#include <algorithm>
#include <iomanip>
#include <map>
#include <ostream>
#include <tuple>

namespace bayesian_icp::evaluate {

namespace {

/** Kolmogorov-Smirnov distance below which a marginal counts as right. */
constexpr double good_ks = 0.06;

using CellName = std::tuple<std::string, double, double>;
using Scores = std::vector<Score>;

double
median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle]
                           : 0.5 * (values[middle - 1] + values[middle]);
}

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
  stream << "                                                  6-D KL           KL 1-D "
            " W1 "
            "    KS<.06 R-hat  bulk ESS  tail ESS ESS/s   CPU [s] mixed\n"
            "scene      sigma  N     sampler           runs   median   worst   median  "
            "median %      worst  smallest  smallest median  median  runs\n";
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
  stream << std::left << std::setw(11) << std::get<0>(cell) << std::setw(7)
         << std::get<1>(cell) << std::setw(6) << std::get<2>(cell) << std::setw(19)
         << sampler << std::right << std::setw(3) << scores.size()
         << std::setprecision(3) << std::setw(9) << median(kl) << std::setw(8)
         << largest(kl) << std::setw(9) << medianCoordinateKl(scores) << std::setw(8)
         << median(w1) << std::setw(6) << 100.0 * shareOfGoodMarginals(scores)
         << std::setprecision(4) << std::setw(8) << largest(rhat) << std::setw(10)
         << smallest(bulk) << std::setw(10) << smallest(tail) << std::setw(8)
         << median(rate) << std::setprecision(3) << std::setw(9) << median(seconds)
         << std::setw(4) << num_mixed << '\n';
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
