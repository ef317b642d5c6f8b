/** \file
 * \brief Numbers as text, and the tables that the studies print. Reports make their own
 * from the CSV files.
 */
#pragma once

#include "study/draw_statistics.h"

#include <array>
#include <cstdio>
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

/** \brief Columns as wide as their widest cell: names on the left, then numbers, which
 * end at the same place.
 * \param[in] rows of as many cells each; the first one is the header */
std::string
textOfTable(const std::vector<std::vector<std::string>>& rows);

/** \brief A column of a summary: what is told of a number of all runs of a group. */
struct SummaryColumn {
  std::string title;
  double (*statistic)(std::vector<double> values) = median;
};

/** \brief The group that a run belongs to, and its numbers, one for each column. */
using GroupedNumbers = std::pair<std::string, std::vector<double>>;

/** \brief A table with a line for each group, in the order of their first runs. NaN is
 * left out of a statistic, which then tells of how many numbers it is; a column of NaN
 * alone is left out.
 * \param[in] title of the groups */
std::string
summaryText(const std::string& title,
            const std::vector<SummaryColumn>& columns,
            const std::vector<GroupedNumbers>& runs);

} // namespace bayesian_icp::evaluate
