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

TextTable
medianTable(const std::vector<std::string>& columns,
            const std::vector<GroupedNumbers>& runs)
{
  constexpr int num_digits = 4;
  std::vector<std::string> header = {"medians of the runs of", "runs"}, groups;
  header.insert(header.end(), columns.begin(), columns.end());
  TextTable table(header);
  for (const auto& [name, numbers] : runs)
    if (std::find(groups.begin(), groups.end(), name) == groups.end())
      groups.push_back(name);
  for (const std::string& group : groups) {
    const auto num_runs = std::count_if(
        runs.begin(), runs.end(), [&](const auto& run) { return run.first == group; });
    std::vector<std::string> cells = {group, std::to_string(num_runs)};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      std::vector<double> known;
      for (const auto& [name, numbers] : runs)
        if (name == group && !std::isnan(numbers[k]))
          known.push_back(numbers[k]);
      cells.push_back(known.empty() ? "-" : io::textOf(median(known), num_digits));
      if (!known.empty() && known.size() < std::size_t(num_runs))
        cells.back() += " (of " + std::to_string(known.size()) + ')';
    }
    table.add(cells);
  }
  return table;
}

} // namespace bayesian_icp::evaluate
