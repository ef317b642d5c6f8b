#include "study/text_table.h"

#include "io/numbers.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace bayesian_icp::evaluate {

namespace {

/** The statistic of the numbers that are known. */
std::string
cellOf(const SummaryColumn& column, const std::vector<double>& numbers)
{
  constexpr int num_digits = 4;
  std::vector<double> known;
  for (const double number : numbers)
    if (!std::isnan(number))
      known.push_back(number);
  if (known.empty())
    return "-";
  const std::string cell = io::textOf(column.statistic(known), num_digits);
  return known.size() == numbers.size()
             ? cell
             : cell + " (of " + std::to_string(known.size()) + ')';
}

} // namespace

std::string
textOfTable(const std::vector<std::vector<std::string>>& rows)
{
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k)
      widths[k] = std::max(widths[k], row[k].size());
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string space(widths[k] - row[k].size(), ' ');
      text += "  " + (k == 0 ? row[k] + space : space + row[k]);
    }
    text += '\n';
  }
  return text;
}

std::string
summaryText(const std::string& title,
            const std::vector<SummaryColumn>& columns,
            const std::vector<GroupedNumbers>& runs)
{
  std::vector<std::vector<std::string>> rows = {{title, "runs"}};
  std::map<std::string, std::vector<const std::vector<double>*>> members;
  for (const auto& [group, numbers] : runs) {
    if (members.count(group) == 0)
      rows.push_back({group});
    members[group].push_back(&numbers);
  }
  for (std::size_t i = 1; i < rows.size(); ++i)
    rows[i].push_back(std::to_string(members[rows[i][0]].size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (std::all_of(runs.begin(), runs.end(), [k](const auto& run) {
          return std::isnan(run.second[k]);
        }))
      continue;
    rows[0].push_back(columns[k].title);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      std::vector<double> numbers;
      for (const std::vector<double>* run : members[rows[i][0]])
        numbers.push_back((*run)[k]);
      rows[i].push_back(cellOf(columns[k], numbers));
    }
  }
  return textOfTable(rows);
}

} // namespace bayesian_icp::evaluate
