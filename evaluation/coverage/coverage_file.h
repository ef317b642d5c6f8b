/** \file
 * \brief The runs of a coverage study and the CSV file that keeps them.
 */
#pragma once

#include "coverage/coverage_score.h"
#include "run_file.h"

#include <string>

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

  static std::string
  header();

  std::string
  row() const;

  /** \throws std::exception if the line is not a row */
  static CoverageRun
  ofRow(const std::string& line);
};

/** \brief The CSV file. Not for several threads at once. */
using CoverageFile = RunFile<CoverageRun>;

} // namespace bayesian_icp::evaluate
