/** \file
 * \brief Files of results, one row per run, in which runs are found by their name.
 *
 * A type of rows says its columns once: `Run::columns(run, column)` calls
 * `column(title, value)` for each, in their order; the values are std::string, bool (0
 * or 1) or numbers. `Run::name` is what tells runs apart, its `columns` are those that
 * do.
 */
#pragma once

#include "io/coordinates.h"
#include "study/csv_fields.h"
#include "study/row_file.h"

#include <Eigen/Core>

#include <deque>
#include <map>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

namespace detail {

inline void
addField(const bool& value, CsvRow& row)
{
  row.add(value ? 1 : 0);
}

template <typename Value>
void
addField(const Value& value, CsvRow& row)
{
  row.add(value);
}

inline void
readField(CsvFields& fields, std::string& value)
{
  value = fields.text();
}

inline void
readField(CsvFields& fields, bool& value)
{
  const std::string text = fields.text();
  if (text != "0" && text != "1")
    throw std::runtime_error("neither 0 nor 1");
  value = text == "1";
}

template <typename Number>
void
readField(CsvFields& fields, Number& value)
{
  fields.read(value);
}

} // namespace detail

/** \brief The titles of the columns. */
template <typename Run>
std::string
headerOf()
{
  CsvRow row;
  const Run run{};
  Run::columns(run, [&row](const std::string& title, const auto&) { row.add(title); });
  return row.text();
}

/** \brief The values, of a run or of a name. */
template <typename Run>
std::string
rowOf(const Run& run)
{
  CsvRow row;
  Run::columns(run, [&row](const std::string&, const auto& value) {
    detail::addField(value, row);
  });
  return row.text();
}

/** \throws std::runtime_error if the line is not a row */
template <typename Run>
Run
runOf(const std::string& line)
{
  CsvFields fields(line);
  Run run;
  Run::columns(run, [&fields](const std::string&, auto& value) {
    detail::readField(fields, value);
  });
  fields.end();
  return run;
}

/** \brief Columns of the six coordinates of a pose. */
template <typename Vector, typename Column>
void
coordinateColumns(const std::string& prefix, Vector& values, const Column& column)
{
  for (Eigen::Index k = 0; k < 6; ++k)
    column(prefix + app::coordinate_names[static_cast<std::size_t>(k)], values[k]);
}

/** \brief A CSV file of runs. Not for several threads at once. */
template <typename Run>
class RunFile {
public:
  using Name = decltype(Run::name);

  /** \brief Read what is there; see RowFile. */
  explicit RunFile(const std::string& file)
  : file_(file, headerOf<Run>(), [this](const std::string& row) {
    keep(runOf<Run>(row));
  })
  {}

  /** \brief The run of this name, or null; valid as long as this object. */
  const Run*
  find(const Name& name) const
  {
    const auto found = places_.find(rowOf(name));
    return found == places_.end() ? nullptr : &runs_[found->second];
  }

  /** \brief Write a row, at once.
   * \throws io::FileError */
  void
  add(const Run& run)
  {
    file_.add(rowOf(run));
    keep(run);
  }

  /** \brief In the order in which they ended. */
  std::vector<Run>
  runs() const
  {
    return {runs_.begin(), runs_.end()};
  }

private:
  void
  keep(const Run& run)
  {
    const auto [place, is_new] = places_.emplace(rowOf(run.name), runs_.size());
    if (is_new)
      runs_.push_back(run);
    else
      runs_[place->second] = run;
  }

  std::deque<Run> runs_;
  std::map<std::string, std::size_t> places_;
  RowFile file_;
};

} // namespace bayesian_icp::evaluate
