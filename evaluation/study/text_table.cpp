#include "study/text_table.h"

#include "io/numbers.h"
#include "study/draw_statistics.h"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

void
TextTable::print(std::ostream& stream) const
{
  std::vector<std::string> first, second;
  for (const std::string& cell : rows_[0]) {
    const std::size_t end = std::min(cell.find('\n'), cell.size());
    first.push_back(cell.substr(0, end));
    second.push_back(cell.substr(std::min(end + 1, cell.size())));
  }
  auto rows = rows_;
  rows[0] = first;
  if (second != std::vector<std::string>(second.size()))
    rows.insert(rows.begin() + 1, second);
  std::vector<std::size_t> widths(first.size(), 0);
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size() && row.size() > 1; ++k)
      widths[k] = std::max(widths[k], row[k].size());
  for (const auto& row : rows) {
    if (row.size() == 1) {
      stream << row[0] << '\n';
      continue;
    }
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string space(widths[k] - row[k].size(), ' ');
      stream << "  " << (k == 0 ? row[k] + space : space + row[k]);
    }
    stream << '\n';
  }
}

std::string
numberText(double value, int num_decimals)
{
  if (std::isnan(value))
    return "-";
  return std::abs(value) < (num_decimals > 0 ? 1e4 : 1e7)
             ? format("%.*f", num_decimals, value)
             : format("%.1e", value);
}

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
  constexpr int num_digits = 4;
  std::vector<std::string> header = {"medians of the runs of", "runs"};
  header.insert(header.end(), columns_.begin(), columns_.end());
  TextTable table(header);
  for (const Group& group : groups_) {
    std::vector<std::string> cells = {group.name, std::to_string(group.num_runs)};
    for (const std::vector<double>& numbers : group.numbers) {
      cells.push_back(numbers.empty() ? "-" : io::textOf(median(numbers), num_digits));
      if (numbers.size() < group.num_runs && !numbers.empty())
        cells.back() += " (of " + std::to_string(numbers.size()) + ')';
    }
    table.add(cells);
  }
  stream << title_ << '\n';
  table.print(stream);
}

} // namespace bayesian_icp::evaluate
