/** \file
 * \brief A file of results, a row a run, in which runs are found by their name.
 */
#pragma once

#include "row_file.h"

#include <map>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief A CSV file of runs, in the order in which they ended. Of a `Run` it needs
 * `Run::header()`, `Run::ofRow(line)`, which throws if the line is none, `row()`, and
 * `name`, which can be compared by `<`. */
template <typename Run>
class RunFile {
public:
  using Name = decltype(Run::name);

  /** \brief Read what is there; see RowFile. */
  explicit RunFile(const std::string& file)
  : file_(file, Run::header(), [this](const std::string& row) {
    const Run run = Run::ofRow(row);
    runs_[run.name] = run;
  })
  {}

  /** \brief The run of this name, or null; valid as long as this object. */
  const Run*
  find(const Name& name) const
  {
    const auto found = runs_.find(name);
    return found == runs_.end() ? nullptr : &found->second;
  }

  /** \brief Write a row, at once.
   * \throws io::FileError */
  void
  add(const Run& run)
  {
    file_.add(run.row());
    runs_[run.name] = run;
  }

private:
  std::map<Name, Run> runs_;
  RowFile file_;
};

} // namespace bayesian_icp::evaluate
