#include "coverage/coverage_methods.h"

#include "algebra/decompositions.h"
#include "calibrated/calibrated_report.h"
#include "calibrated/flat_clouds.h"
#include "calibrated/surface/surface_model.h"
#include "geometry/twist.h"
#include "io/clocks.h"
#include "io/command_line.h"
#include "io/numbers.h"
#include "methods/published_covariances.h"
#include "register/choices.h"
#include "study/text_table.h"

#include <algorithm>
#include <new>

namespace bayesian_icp::evaluate {

namespace {

Eigen::Vector3d
centroidOf(const CoverageCase& problem)
{
  return problem.source.rowwise().mean();
}

/** The prior itself: the control. */
MethodResult
runPrior(const CoverageCase& problem)
{
  MethodResult result;
  result.mean = isometryOf(problem.prior_mean);
  result.centre = result.mean * centroidOf(problem);
  result.covariance =
      twistPrior(priorOf(problem), result.mean, result.centre).precision.inverse();
  result.num_queries = 0;
  result.is_valid = true;
  return result;
}

/** Algorithm 1 of the paper with its options, and the case's prior. */
MethodResult
runPaperPreset(const CoverageCase& problem)
{
  Options options;
  options.preset = Preset::Paper;
  MethodResult result = resultOf(problem, presetEstimate(problem, options));
  const PaperOptions& paper = options.paper;
  result.num_queries =
      (static_cast<long>(options.chains.num_chains) * paper.num_burn_in +
       static_cast<long>(options.chains.num_draws) * paper.thinning) *
      std::min<long>(paper.batch_size, problem.source.cols());
  return result;
}

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
  for (const DataFlag& flag : data_flags)
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

/** The calibrated Gaussian; notes are its flags and the number of directions held by
 * the prior only. */
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

using Baseline = std::function<MethodResult(const BaselineProblem&)>;

MethodResult
naive(const BaselineProblem& problem)
{
  const IcpFit fit = fitNaively(problem);
  const GaussNewton sums = gaussNewton(fit.matches, problem.centreAt(fit.pose));
  return problem.combineWithPrior(
      fit.pose, {sums.hessian / fit.variance, sums.gradient / fit.variance});
}

MethodResult
closedForm(const BaselineProblem& problem)
{
  const IcpFit fit = fitPlanes(problem);
  const auto derivatives =
      closedFormDerivatives(fit.matches, problem.centreAt(fit.pose));
  return problem.combineWithPrior(fit.pose,
                                  closedFormInformation(derivatives, fit.pointSigma()));
}

MethodResult
sandwich(const BaselineProblem& problem)
{
  const IcpFit fit = fitNaively(problem);
  const double noise =
      SurfaceModel(problem.coverage_case.target, SurfaceModelOptions(), 1)
          .medianSigma();
  return problem.combineWithPrior(fit.pose, pointToPointSandwich(problem, fit, noise));
}

MethodResult
gicpWithHessian(const BaselineProblem& problem)
{
  const GicpFit gicp = fitPclGicp(problem.ofPcl());
  MethodResult result;
  if (gicp.moved.cols() == 0) {
    result.notes = "too few points";
    return result;
  }
  GaussianInformation information;
  information.information = generalizedIcpHessian(
      gicp.moved, gicp.covariances, problem.centreAt(gicp.fit.pose));
  result = problem.combineWithPrior(gicp.fit.pose, information);
  result.num_queries = -1;
  if (!gicp.fit.has_converged)
    result.notes = "not converged";
  return result;
}

/** A registration that says nothing about its error. */
Baseline
poseOnly(PclFit (*fit)(const PclProblem&))
{
  return [fit](const BaselineProblem& problem) {
    const PclFit found = fit(problem.ofPcl());
    MethodResult result;
    result.is_valid = result.is_pose_only = true;
    result.mean = found.pose;
    result.notes = found.has_converged ? "pose only" : "pose only;not converged";
    return result;
  };
}

/** \p baseline for clouds that are not empty. */
CoverageMethod
method(const std::string& name, const Baseline& baseline)
{
  return {name, [baseline](const CoverageCase& coverage_case) {
            if (coverage_case.source.cols() == 0 || coverage_case.target.cols() == 0) {
              MethodResult refused;
              refused.notes = "empty cloud";
              return refused;
            }
            return baseline(BaselineProblem(coverage_case));
          }};
}

} // namespace

std::vector<CoverageMethod>
baselineMethods()
{
  return {method("naive", naive),
          method("closed-form", closedForm),
          method("point-to-point-sandwich", sandwich),
          method("gicp-hessian", gicpWithHessian),
          method("gicp", poseOnly(fitPclGicpAsIs)),
          method("icp", poseOnly(fitPclIcp))};
}

std::vector<CoverageMethod>
coverageMethods()
{
  std::vector<CoverageMethod> methods = {{"prior", runPrior},
                                         {"paper", runPaperPreset}};
  for (CoverageMethod& baseline : baselineMethods())
    methods.push_back(std::move(baseline));
  methods.push_back({"calibrated", runCalibrated});
  methods.push_back({"calibrated-draws", runCalibratedDraws});
  return methods;
}

MethodResult
timedResult(const CoverageMethod& method, const CoverageCase& problem)
{
  const double begin = io::wallSeconds();
  MethodResult result;
  try {
    result = method.run(problem);
  }
  catch (const std::bad_alloc&) {
    throw; // no fault of the method
  }
  catch (const std::exception& error) {
    result.notes = std::string("exception: ") + error.what();
  }
  result.seconds = io::wallSeconds() - begin;
  return result;
}

CoverageMethod
exactMethod(const std::string& name)
{
  const auto words = io::splitAt(':', name);
  Options options;
  options.preset = Preset::Exact;
  ExactOptions& exact = options.exact;
  LikelihoodScale& scale = exact.scale;
  if (words.size() != 6 || words[0] != "exact" ||
      !app::readChoice(std::string(words[1]), exact.residual.residual) ||
      !app::readChoice(std::string(words[2]), exact.steps) ||
      !io::readNumber(words[3], scale.measurement_sigma) ||
      !io::readNumber(words[4], scale.effective_points) ||
      !io::readNumber(words[5], exact.max_source_points) || !options.validate().empty())
    io::refuseValue(name, "of the form exact:RESIDUAL:STEPS:SIGMA:N:POINTS");
  return {name, [options](const CoverageCase& problem) {
            return resultOf(problem, presetEstimate(problem, options));
          }};
}

PosteriorEstimate
presetEstimate(const CoverageCase& problem, Options options)
{
  options.prior.mean = problem.prior_mean;
  options.prior.variance = problem.prior_sd.cwiseAbs2();
  options.prior.frame = PriorFrame::SourceCentroid;
  options.chains.seed = problem.seed;
  options.chains.num_threads = 1;
  return estimatePosterior(problem.source, problem.target, problem.prior_mean, options);
}

MethodResult
resultOf(const CoverageCase& problem, const PosteriorEstimate& estimate)
{
  const Summary& summary = estimate.summary;
  MethodResult result;
  if (summary.status != Status::Ok)
    result.notes = std::string("flag:") + toString(summary.status);
  result.is_valid = estimate.samples.rows() > 0;
  if (!result.is_valid)
    return result;
  result.mean = isometryOf(summary.mean);
  result.centre = result.mean * centroidOf(problem);
  result.draws = estimate.samples;
  result.num_queries = -1;
  return result;
}

Prior
priorOf(const CoverageCase& problem)
{
  return {problem.prior_mean, problem.prior_sd.cwiseAbs2(), centroidOf(problem)};
}

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
