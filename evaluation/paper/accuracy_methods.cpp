#include "paper/accuracy_methods.h"

#include "baselines/iterative_closest_point.h"
#include "geometry/twist.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/stochastic_gradient_icp.h>
#include <bayesian_icp/tree_search.h>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_burn_in = 500;
constexpr int max_icp_iterations = 1000;

/** Of a uniform distribution. */
double
varianceOf(double half_range)
{
  return half_range * half_range / 3.0;
}

PriorOptions
priorOf(Preset preset)
{
  PriorOptions prior;
  if (preset == Preset::Paper) {
    prior.mean.setZero();
    return prior;
  }
  prior.variance.head<3>().setConstant(varianceOf(accuracy_translation_range));
  prior.variance.tail<3>().setConstant(varianceOf(accuracy_rotation_range));
  return prior;
}

AccuracyEstimate
bayesianMean(Preset preset, const PaperProblem& problem, const DrawPlan& plan)
{
  Options options;
  options.preset = preset;
  options.prior = priorOf(preset);
  options.chains.seed = plan.seed;
  options.chains.num_threads = plan.num_threads;
  options.paper.num_burn_in = num_burn_in;
  const PosteriorEstimate estimate =
      estimatePosterior(problem.pair.source, problem.tree, plan.start, options);
  AccuracyEstimate result{estimate.summary.mean, toString(estimate.summary.status)};
  if (estimate.samples.rows() == 0)
    result.pose.setConstant(std::numeric_limits<double>::quiet_NaN());
  return result;
}

AccuracyEstimate
sgdIcp(bool is_one_to_one, const PaperProblem& problem, const DrawPlan& plan)
{
  StochasticGradientIcpOptions options;
  options.seed = plan.seed;
  options.is_one_to_one = is_one_to_one;
  const TreeSearch search(problem.tree, std::numeric_limits<double>::infinity());
  const StochasticGradientIcpResult result =
      stochasticGradientIcp(problem.pair.source, search, plan.start, options);
  return {result.pose, toString(result.end)};
}

AccuracyEstimate
icp(const PaperProblem& problem, const DrawPlan& plan)
{
  IcpOptions options;
  options.max_iterations = max_icp_iterations;
  const IcpResult result = iterativeClosestPoint(
      problem.pair.source, problem.tree, isometryOf(plan.start), options);
  return {poseOf(result.T_target_source.matrix()), toString(result.stop)};
}

AccuracyMethod
sgdMethod(const char* name, bool is_one_to_one)
{
  return {name, [is_one_to_one](const PaperProblem& problem, const DrawPlan& plan) {
            return sgdIcp(is_one_to_one, problem, plan);
          }};
}

AccuracyMethod
bayesianMethod(const char* name, Preset preset)
{
  return {name, [preset](const PaperProblem& problem, const DrawPlan& plan) {
            return bayesianMean(preset, problem, plan);
          }};
}

} // namespace

const std::vector<AccuracyMethod>&
accuracyMethods()
{
  static const std::vector<AccuracyMethod> methods = {
      bayesianMethod("paper", Preset::Paper),
      bayesianMethod("exact", Preset::Exact),
      bayesianMethod("calibrated", Preset::Calibrated),
      sgdMethod("sgd-icp", false),
      sgdMethod("sgd-icp-filter", true),
      {"icp", icp}};
  return methods;
}

} // namespace bayesian_icp::evaluate
