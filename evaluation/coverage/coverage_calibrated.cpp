#include "calibrated/calibrated_report.h"
#include "calibrated/flat_clouds.h"
#include "coverage/coverage_methods.h"
#include "register/report_text.h"
#include "study/text_table.h"

#include <algorithm>

namespace bayesian_icp::evaluate {

namespace {

std::string
numberNote(const char* name, double value)
{
  return format(";%s=%.3g", name, value);
}

long
numPriorOnly(const DataReport& report)
{
  return std::count_if(
      report.directions.begin(), report.directions.end(), [](const auto& direction) {
        return direction.observability == Observability::PriorOnly;
      });
}

/** The raised flags, how many directions the data say nothing about, and the
 * numbers that the flags are made of. */
std::string
notesOf(const DataReport& report)
{
  std::string notes;
  for (const app::DataFlag& flag : app::data_flags)
    if (report.flags.*flag.is_raised)
      notes += std::string("flag:") + flag.key + ';';
  return notes + "prior_only=" + std::to_string(numPriorOnly(report)) +
         numberNote("basin_distance", report.basin_distance) +
         numberNote("active", report.active_fraction) +
         numberNote("active_of_target", report.active_fraction_of_target) +
         numberNote("other_cost_ratio", report.other_cost_ratio) +
         numberNote("patches", report.effective_patches) +
         numberNote("residual_scale", report.residual_scale) +
         numberNote("correlation", report.correlation_factor) +
         numberNote("prior_probability", report.prior_probability);
}

/** A case, ready to be estimated. */
struct Registration {
  explicit Registration(const CoverageCase& problem)
  : source(
        prepareSurface(problem.source, 1, numDoublings(problem.source, problem.target)))
  , target(
        prepareSurface(problem.target, 1, numDoublings(problem.target, problem.source)))
  , prior(priorOf(problem))
  , scorer(scorerOf(problem.source,
                    source,
                    problem.target,
                    target,
                    CalibratedOptions().max_source_points,
                    problem.seed,
                    1,
                    reachOf(problem.source, source.columns, prior)))
  {}

  CalibratedEstimate
  estimate() const
  {
    const HeldPrior held = heldInPlane(prior, source.model, target.model);
    CalibratedEstimate result = estimateCalibrated(scorer, held);
    if (held.plane)
      setPrior(prior, result);
    return result;
  }

  PreparedSurface source, target;
  Prior prior;
  SurfaceScorer scorer;
};

} // namespace

MethodResult
resultOf(const CalibratedEstimate& estimate)
{
  MethodResult result;
  result.is_valid = true;
  result.mean = movedBy(estimate.mean, estimate.centre, estimate.mode);
  result.covariance = estimate.covariance;
  result.centre = estimate.centre;
  result.shape = {estimate.degrees_of_freedom,
                  static_cast<int>((estimate.keep.array() > 0.0).count())};
  return result;
}

CalibratedEstimate
calibratedEstimateOf(const CoverageCase& problem)
{
  return Registration(problem).estimate();
}

MethodResult
runCalibrated(const CoverageCase& problem)
{
  const Registration registration(problem);
  const CalibratedEstimate estimate = registration.estimate();
  MethodResult result = resultOf(estimate);
  result.notes = notesOf(dataReportOf(estimate, registration.scorer.noise()));
  result.num_queries = registration.scorer.numQueries();
  return result;
}

MethodResult
runCalibratedDraws(const CoverageCase& problem)
{
  Options options;
  options.preset = Preset::Calibrated;
  const PosteriorEstimate estimate = presetEstimate(problem, options);
  MethodResult result = resultOf(problem, estimate);
  const DataReport& report = estimate.summary.data;
  if (report.is_available) {
    result.shape = {report.degrees_of_freedom,
                    static_cast<int>(6 - numPriorOnly(report))};
    result.notes += (result.notes.empty() ? "" : ";") + notesOf(report);
  }
  return result;
}

} // namespace bayesian_icp::evaluate
