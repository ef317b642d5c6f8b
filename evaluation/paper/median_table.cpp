#include "paper/median_table.h"

#include "io/numbers.h"
#include "study/draw_statistics.h"
#include "study/formatted_text.h"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_digits = 4;

std::string
medianText(const std::vector<double>& numbers)
{
  return numbers.empty() ? "-" : io::textOf(median(numbers), num_digits);
}

} // namespace

void
MedianTable::add(const std::string& group, const std::vector<double>& numbers)
{
  auto found = std::find_if(groups_.begin(), groups_.end(), [&group](const Group& g) {
    return g.name == group;
  });
  if (found == groups_.end())
    found =
        groups_.insert(found, {group, 0, decltype(Group::numbers)(columns_.size())});
  ++found->num_runs;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isnan(numbers[i]))
      found->numbers[i].push_back(numbers[i]);
}

void
MedianTable::print(std::ostream& stream) const
{
  stream << title_ << '\n' << format("  %-40s %5s", "medians of the runs of", "runs");
  for (const std::string& column : columns_)
    stream << format(" %10s", column.c_str());
  stream << '\n';
  for (const Group& group : groups_) {
    stream << format("  %-40s %5zu", group.name.c_str(), group.num_runs);
    for (const std::vector<double>& numbers : group.numbers)
      stream << format(" %10s", medianText(numbers).c_str());
    stream << '\n';
  }
}

} // namespace bayesian_icp::evaluate
