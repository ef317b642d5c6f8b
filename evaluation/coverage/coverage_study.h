/** \file
 * \brief Runs of a coverage study that are not in its file yet, on all cores.
 */
#pragma once

#include "coverage/coverage_file.h"
#include "coverage/coverage_methods.h"
#include "study/parallel_tasks.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Which case. */
struct CoverageCaseName {
  std::string scene;
  std::string condition;
  std::uint64_t seed;
};

/** \brief Makes a case; called by several threads at once. */
using CoverageCaseMaker = std::function<CoverageCase(const CoverageCaseName&)>;

/** \brief What is run. */
struct CoverageStudy {
  std::vector<CoverageCaseName> cases;
  std::vector<CoverageMethod> methods;
  CoverageCaseMaker make_case;
  /** Called after each case by one thread at a time; may be empty. */
  std::function<void(const StudyProgress&, const CoverageCaseName&)> report;
  int num_threads = 1;
};

/** \brief Run every method on every case, except what \p results has. A row does not
 * depend on the number of threads.
 * \throws io::FileError, and what make_case throws; rows of other cases are kept */
void
runCoverageStudy(const CoverageStudy& study, CoverageFile& results);

/** \brief The rows of the study, in its order. */
std::vector<CoverageRun>
runsOf(const CoverageStudy& study, const CoverageFile& results);

} // namespace bayesian_icp::evaluate
