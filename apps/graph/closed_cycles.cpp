#include "graph/closed_cycles.h"

#include "io/numbers.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <map>

namespace bayesian_icp::app {

namespace {

std::string
verticesOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  int vertex = edges[cycle.direct].target;
  std::string text = io::textOf(vertex);
  for (const std::size_t k : cycle.path) {
    vertex = vertex == edges[k].target ? edges[k].source : edges[k].target;
    text += '-' + io::textOf(vertex);
  }
  return text;
}

CycleStatistics
statisticsOf(const std::string& name, const std::vector<const ClosedCycle*>& cycles)
{
  CycleStatistics sum;
  sum.name = name;
  sum.num_cycles = cycles.size();
  for (const ClosedCycle* closed : cycles) {
    sum.nees_per_degree += closed->closure.squared_error;
    sum.num_degrees += closed->closure.num_degrees;
    sum.share_in_half += closed->closure.probability > 0.5 ? 1.0 : 0.0;
    sum.share_in_95 += closed->closure.probability > 0.05 ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(cycles.size());
  sum.nees_per_degree /= sum.num_degrees;
  for (double* const mean : {&sum.num_degrees, &sum.share_in_half, &sum.share_in_95})
    *mean /= count;
  return sum;
}

} // namespace

std::vector<ClosedCycle>
closedCycles(const std::vector<GraphEdge>& edges, std::size_t max_length)
{
  std::vector<ClosedCycle> closed;
  for (const Cycle& cycle : cyclesOf(edges, max_length)) {
    const Closure closure = closureOf(edges, cycle);
    if (closure.num_degrees > 0)
      closed.push_back({verticesOf(edges, cycle), cycle, closure});
  }
  return closed;
}

std::vector<CycleStatistics>
statisticsOf(const std::vector<ClosedCycle>& cycles)
{
  std::map<std::size_t, std::vector<const ClosedCycle*>> of_length;
  std::vector<const ClosedCycle*> all;
  for (const ClosedCycle& closed : cycles) {
    of_length[closed.length()].push_back(&closed);
    all.push_back(&closed);
  }
  std::vector<CycleStatistics> lines;
  for (const auto& [length, members] : of_length)
    lines.push_back(statisticsOf(io::textOf(length), members));
  if (!all.empty())
    lines.push_back(statisticsOf("all", all));
  return lines;
}

std::vector<ClosedCycle>
openCycles(std::vector<ClosedCycle> cycles)
{
  cycles.erase(
      std::remove_if(cycles.begin(),
                     cycles.end(),
                     [](const ClosedCycle& closed) { return closed.closes(); }),
      cycles.end());
  std::sort(
      cycles.begin(), cycles.end(), [](const ClosedCycle& a, const ClosedCycle& b) {
        return a.closure.probability < b.closure.probability;
      });
  return cycles;
}

std::vector<Suspect>
suspectsOf(const std::vector<ClosedCycle>& cycles)
{
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> counts; // open, all
  for (const ClosedCycle& closed : cycles) {
    std::vector<std::size_t> members = closed.cycle.path;
    members.push_back(closed.cycle.direct);
    for (const std::size_t k : members) {
      counts[k].first += closed.closes() ? 0 : 1;
      ++counts[k].second;
    }
  }
  std::vector<Suspect> suspects;
  for (const auto& [k, count] : counts)
    if (count.first == count.second && count.second > 1)
      suspects.push_back({k, count.second});
  return suspects;
}

double
probabilityOf(const std::vector<ClosedCycle>& cycles)
{
  if (cycles.empty())
    return 1.0;
  double squared_error = 0.0, num_degrees = 0.0;
  for (const ClosedCycle& closed : cycles) {
    squared_error += closed.closure.squared_error;
    num_degrees += closed.closure.num_degrees;
  }
  return boost::math::cdf(
      boost::math::complement(boost::math::chi_squared(num_degrees), squared_error));
}

} // namespace bayesian_icp::app
