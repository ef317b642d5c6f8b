/** \file
 * \brief Numbers as text, and tables that the studies print.
 */
#pragma once

#include <array>
#include <cstdio>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A text as printf() makes it, of at most 255 characters. */
template <typename... Values>
std::string
format(const char* pattern, Values... values)
{
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

/** \brief So many digits after the point, fewer of a number so large that
 * nobody reads them; "-" of NaN. */
std::string
numberText(double value, int num_decimals);

/** \brief Columns as wide as their widest cell: names on the left, then
 * numbers, which end at the same place. */
class TextTable {
public:
  /** \param[in] header what follows a line break is on a second line */
  explicit TextTable(const std::vector<std::string>& header) : rows_{header} {}

  /** \brief A line of all rows that follow, across the columns. */
  void
  addTitle(const std::string& title)
  {
    rows_.push_back({title});
  }

  /** \param[in] cells one for each column */
  void
  add(std::vector<std::string> cells)
  {
    rows_.push_back(std::move(cells));
  }

  void
  print(std::ostream& stream) const;

  /** \brief The header, and what was added; a row of one cell is a title. */
  const std::vector<std::vector<std::string>>&
  rows() const
  {
    return rows_;
  }

private:
  std::vector<std::vector<std::string>> rows_;
};

/** \brief The group that a run belongs to, and its numbers, one for each column. */
using GroupedNumbers = std::pair<std::string, std::vector<double>>;

/** \brief Medians of the numbers of runs, a line for each group in the order of their
 * first runs. NaN is left out of a median, which then tells of how many numbers it is.
 */
TextTable
medianTable(const std::vector<std::string>& columns,
            const std::vector<GroupedNumbers>& runs);

} // namespace bayesian_icp::evaluate
