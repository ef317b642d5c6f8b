/** \file
 * \brief The runs of a coverage study and the CSV file that keeps them.
 */
#pragma once

#include "coverage_score.h"
#include "row_file.h"

#include <map>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Which run. */
struct CoverageRunName {
  std::string scene;
  std::string condition;
  std::uint64_t seed = 0;
  std::string method;

  bool
  operator<(const CoverageRunName& other) const;
};

struct CoverageRun {
  CoverageRunName name;
  CoverageScore score;
};

/** \brief The CSV file: a row a run, in the order in which they ended. Not for several
 * threads at once. */
class CoverageFile {
public:
  /** \brief Read what is there; see RowFile. */
  explicit CoverageFile(const std::string& name);

  /** \brief The run of this name, or null. */
  const CoverageRun*
  find(const CoverageRunName& name) const;

  /** \brief Write a row, at once.
   * \throws io::FileError */
  void
  add(const CoverageRun& run);

private:
  std::map<CoverageRunName, CoverageRun> runs_;
  RowFile file_;
};

} // namespace bayesian_icp::evaluate
