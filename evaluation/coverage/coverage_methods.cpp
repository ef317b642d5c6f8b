#include "coverage/coverage_methods.h"

#include "algebra/decompositions.h"
#include "geometry/twist.h"
#include "io/clocks.h"
#include "io/command_line.h"
#include "io/numbers.h"
#include "register/choices.h"

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

} // namespace

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

} // namespace bayesian_icp::evaluate
