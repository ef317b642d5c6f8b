#include "paper/median_table.h"

#include "io/numbers.h"
#include "study/draw_statistics.h"
#include "study/text_table.h"

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
  std::vector<std::string> header = {"medians of the runs of", "runs"};
  header.insert(header.end(), columns_.begin(), columns_.end());
  TextTable table(header);
  for (const Group& group : groups_) {
    std::vector<std::string> cells = {group.name, std::to_string(group.num_runs)};
    for (const std::vector<double>& numbers : group.numbers)
      cells.push_back(medianText(numbers));
    table.add(cells);
  }
  stream << title_ << '\n';
  table.print(stream);
}

} // namespace bayesian_icp::evaluate
