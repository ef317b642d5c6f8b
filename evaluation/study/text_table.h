/** \file
 * \brief Tables that the studies print.
 */
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Columns as wide as their widest cell: names on the left, then
 * numbers, which end at the same place. */
class TextTable {
public:
  /** \param[in] header what follows a line break is on a second line */
  explicit TextTable(const std::vector<std::string>& header);

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

private:
  /** One cell is a title. */
  std::vector<std::vector<std::string>> rows_;
};

/** \brief So many digits after the point, fewer of a number so large that
 * nobody reads them; "-" of NaN. */
std::string
numberText(double value, int num_decimals);

} // namespace bayesian_icp::evaluate
