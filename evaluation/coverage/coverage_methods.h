/** \file
 * \brief The methods that the coverage study compares.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"
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
std::vector<CoverageMethod>
coverageMethods();

/** \brief Run a method and measure its time; an exception is a result that is not
 * valid, with its message as the note. */
MethodResult
timedResult(const CoverageMethod& method, const CoverageCase& problem);

/** \brief Preset `exact` with the residual, steps, sigma [m], N and largest number of
 * source points that \p name states: exact:RESIDUAL:STEPS:SIGMA:N:POINTS.
 * \throws io::BadValue of another form or value */
CoverageMethod
exactMethod(const std::string& name);

/** \brief What the library makes of a case with \p options, but the case's prior and
 * seed, in one thread. */
PosteriorEstimate
presetEstimate(const CoverageCase& problem, Options options);

/** \brief Its draws as a result; a status that is not Ok is a flag. Queries are not
 * counted. */
MethodResult
resultOf(const CoverageCase& problem, const PosteriorEstimate& estimate);

/** \brief The case's prior, about the source's centroid. */
Prior
priorOf(const CoverageCase& problem);

/** \brief What others make of a registration's uncertainty.
 *
 * All that have a covariance combine with the case's prior as a calibrated user would:
 * the method's information and the prior's add up in twists about the moved source's
 * centroid, and the mean is one Newton step from the method's pose. At most 2000 source
 * points are registered, a random choice, unless said otherwise. All use one thread and
 * leave MethodResult::seconds to the caller.
 *
 * In this order:
 * - `naive`: point-to-point ICP with the prior; sigma^2 H^-1, sigma^2 the residuals'
 *   variance, every point independent;
 * - `closed-form`: point-to-plane ICP with the prior from there; Censi's covariance,
 *   sigma from the residuals' median;
 * - `point-to-point-sandwich`: the pose of `naive`; scores clustered in space and
 *   curvature by secants;
 * - `gicp-hessian`: PCL's GICP from the prior's mean; the inverse of its Hessian, in
 *   which a point is known to 1 m in its plane and 0.03 m across, whatever the scene;
 * - `gicp`: PCL's GICP as it comes, but with 50 iterations, from the prior's mean and
 *   with all source points; a pose only;
 * - `icp`: PCL's ICP from the prior's mean; a pose only. */
std::vector<CoverageMethod>
baselineMethods();

/** \brief The estimate behind both methods `calibrated`, with as many source points as
 * the preset takes. */
CalibratedEstimate
calibratedEstimateOf(const CoverageCase& problem);

/** \brief An estimate's posterior as a result, without notes and queries. */
MethodResult
resultOf(const CalibratedEstimate& estimate);

/** \brief What a user gets: 2000 draws of the preset, from all modes, with its status
 * as a flag. */
MethodResult
runCalibratedDraws(const CoverageCase& problem);

} // namespace bayesian_icp::evaluate
