/** \file
 * \brief The methods that the coverage study compares.
 */
#pragma once

#include "coverage_case.h"

#include <bayesian_icp/prior.h>

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A way to get a posterior. */
struct CoverageMethod {
  std::string name;
  /** Uses one thread, is called by several at once, and depends on nothing but the
   * case. Exceptions become invalid results. */
  std::function<MethodResult(const CoverageCase&)> run;
};

/** \brief All methods, in the order of the tables. */
const std::vector<CoverageMethod>&
coverageMethods();

/** \brief Run a method and measure its time; an exception is a result that is not
 * valid, with its message as the note. */
MethodResult
timedResult(const CoverageMethod& method, const CoverageCase& problem);

/** \brief The case's prior, about the source's centroid. */
Prior
priorOf(const CoverageCase& problem);

} // namespace bayesian_icp::evaluate
