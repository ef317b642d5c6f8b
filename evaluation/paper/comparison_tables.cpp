#include "paper/distribution_tables.h"

#include <array>

namespace bayesian_icp::evaluate {

namespace {

/** What stands for the paper's two methods. */
struct Contest {
  const char* bayesian;
  const char* online;
};
constexpr std::array<Contest, 3> contests = {{{"bayesian-icp", "online-icp"},
                                              {"bayesian-icp", "online-icp-noise"},
                                              {"exact", "online-icp"}}};

std::string
nameOf(const Contest& contest)
{
  return paperMethod(contest.bayesian).title + " / " +
         paperMethod(contest.online).title;
}

/** How many objects have the paper's order in a coordinate. */
struct Agreement {
  int num_same = 0, num_opposite = 0, num_undecided = 0;
};
using Agreements = std::array<Agreement, contests.size()>;

/** "yes", "no" or "undecided", which is counted. */
std::string
verdict(const PairDistribution& pair,
        const PaperCell& paper,
        const Contest& contest,
        int k,
        Agreement& counts)
{
  std::string same =
      agreement(orderOf(paper.bayesian, paper.online),
                orderOf(spreadIn(pair, contest.bayesian, coordinateKl(k)),
                        spreadIn(pair, contest.online, coordinateKl(k))));
  ++(same == "yes" ? counts.num_same
                   : (same == "no" ? counts.num_opposite : counts.num_undecided));
  return same;
}

ReportTable
coordinateComparison(const Distributions& distributions, int k, Agreements& counts)
{
  const std::vector<const char*> methods = {
      "bayesian-icp", "exact", "online-icp", "online-icp-noise"};
  ReportTable table;
  table.caption =
      std::string("KL(baseline ‖ method) of ") +
      coordinate_names[static_cast<std::size_t>(k)] +
      " [nats], mean ± standard deviation over the runs: the paper's, ours, "
      "and whether the same of two methods is the lower one.";
  table.header = {"object", "paper: Bayesian ICP", "paper: Online-ICP", "paper: lower"};
  for (const char* method : methods)
    table.header.push_back("ours: " + paperMethod(method).title);
  for (const Contest& contest : contests)
    table.header.push_back("same: " + nameOf(contest));
  for (const PairDistribution& pair : distributions) {
    const auto paper = paperCell(pair.pair->name, k);
    if (!paper)
      continue;
    std::vector<std::string> row = {pair.pair->name,
                                    textOf(paper->bayesian),
                                    shortText(paper->online.mean),
                                    toString(orderOf(paper->bayesian, paper->online))};
    for (const char* method : methods)
      row.push_back(textOf(spreadIn(pair, method, coordinateKl(k))));
    for (std::size_t i = 0; i < contests.size(); ++i)
      row.push_back(verdict(pair, *paper, contests[i], k, counts[i]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

} // namespace

Spread
spreadIn(const PairDistribution& pair,
         const std::string& method,
         const RunNumber& number)
{
  std::vector<double> values;
  for (const DistributionRun& run : pair.runs)
    if (run.name.method == method)
      values.push_back(number(run));
  return spreadOf(values);
}

RunNumber
coordinateKl(int k)
{
  return [k](const DistributionRun& run) { return run.score.coordinate_kl[k]; };
}

std::vector<ReportTable>
comparisonTables(const Distributions& distributions)
{
  ReportTable summary;
  summary.caption =
      "Is the same of two methods nearer to the baseline as in the paper? Number of "
      "objects: same / opposite / undecided, that is, in the paper or here the two "
      "differ by no more than their standard deviations.";
  summary.header = {"coordinate"};
  for (const Contest& contest : contests)
    summary.header.push_back(nameOf(contest));
  std::vector<ReportTable> tables = {summary};
  for (int k = 0; k < 6; ++k) {
    Agreements counts;
    tables.push_back(coordinateComparison(distributions, k, counts));
    std::vector<std::string> row = {coordinate_names[static_cast<std::size_t>(k)]};
    for (const Agreement& count : counts)
      row.push_back(std::to_string(count.num_same) + " / " +
                    std::to_string(count.num_opposite) + " / " +
                    std::to_string(count.num_undecided));
    tables.front().rows.push_back(std::move(row));
  }
  if (tables.back().rows.empty())
    tables.clear();
  return tables;
}

} // namespace bayesian_icp::evaluate
