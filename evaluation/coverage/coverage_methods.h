/** \file
 * \brief The methods that the coverage study compares.
 */
#pragma once

#include "study/coverage_case.h"

#include <bayesian_icp/pipeline.h>

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

/** \brief What the library makes of a case with a preset's defaults and the case's
 * prior and seed, in one thread. */
PosteriorEstimate
presetEstimate(const CoverageCase& problem, Preset preset);

/** \brief Its draws as a result; a status that is not Ok is a flag. Queries are not
 * counted. */
MethodResult
resultOf(const CoverageCase& problem, const PosteriorEstimate& estimate);

/** \brief The case's prior, about the source's centroid. */
Prior
priorOf(const CoverageCase& problem);

} // namespace bayesian_icp::evaluate
