/** \file
 * \brief What an experiment prints when it is done: medians, the rest is in the report.
 */
#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Medians of the numbers of runs, a line for each group of runs. */
class MedianTable {
public:
  MedianTable(std::string title, std::vector<std::string> columns)
  : title_(std::move(title))
  , columns_(std::move(columns))
  {}

  /** \brief A run of this group. NaN is left out of the medians.
   * \param[in] numbers one for each column */
  void
  add(const std::string& group, const std::vector<double>& numbers);

  /** \brief Groups are in the order of their first runs. */
  void
  print(std::ostream& stream) const;

private:
  struct Group {
    std::string name;
    std::size_t num_runs = 0;
    /** Of each column. */
    std::vector<std::vector<double>> numbers;
  };

  std::string title_;
  std::vector<std::string> columns_;
  std::vector<Group> groups_;
};

} // namespace bayesian_icp::evaluate
