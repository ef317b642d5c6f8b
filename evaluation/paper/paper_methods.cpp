#include "paper/paper_methods.h"

#include "geometry/twist.h"
#include "io/clocks.h"
#include "paper/monte_carlo_icp.h"
#include "study/draw_statistics.h"
#include "study/named.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/stochastic_gradient_icp.h>
#include <bayesian_icp/tree_search.h>

#include <limits>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

/** Random numbers of draws from Gaussians. */
constexpr std::uint64_t gaussian_stream = 0x67617573;

/** Noise of Online-ICP: that of the paper's likelihood [m], or found by itself. */
constexpr double paper_sigma = 1.0;
constexpr double estimated = std::numeric_limits<double>::quiet_NaN();

using OptionChange = std::function<void(Options&)>;

/** A preset with the paper's prior and likelihood, its defaults, and this change. */
PaperMethod
preset(const std::string& name, const OptionChange& change)
{
  return {name, [change](const PaperProblem& problem, const DrawPlan& plan) {
            Options options;
            options.chains.num_draws = plan.num_draws;
            options.chains.seed = plan.seed;
            options.chains.num_threads = plan.num_threads;
            options.paper.initial_spread.setConstant(plan.initial_spread);
            change(options);
            return runPreset(problem.pair.source, problem.tree, options, plan.start);
          }};
}

/** The pair as the baselines want it: with a prior so wide that it only holds what the
 * points do not. */
CoverageCase
caseOf(const ScanPair& pair)
{
  CoverageCase made;
  made.scene = pair.name;
  made.seed = 1;
  made.source = pair.source;
  made.target = pair.target;
  made.prior_sd = PriorOptions().variance.cwiseSqrt();
  return made;
}

PoseMatrix
drawsOf(const TwistGaussian& gaussian, const DrawPlan& plan)
{
  const auto factor = factorOf(gaussian.covariance);
  if (!factor)
    return PoseMatrix(0, 6);
  Random random(plan.seed, gaussian_stream);
  PoseMatrix draws(plan.num_draws, 6);
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    draws.row(i) =
        poseOf(movedBy(*factor * random.normal6(), gaussian.centre, gaussian.mean)
                   .matrix())
            .transpose();
  return draws;
}

PaperMethod
gaussian(const std::string& name,
         const std::function<TwistGaussian(const CoverageCase&)>& fit)
{
  return {name, [name, fit](const PaperProblem& problem, const DrawPlan& plan) {
            const double begin = io::cpuSeconds();
            auto known = problem.gaussians.find(name);
            if (known == problem.gaussians.end()) {
              const TwistGaussian fitted = fit(caseOf(problem.pair));
              known = problem.gaussians
                          .emplace(name, std::pair(fitted, io::cpuSeconds() - begin))
                          .first;
            }
            const auto& [gaussian_of_pair, fit_seconds] = known->second;
            const double fitted_at = io::cpuSeconds();
            SamplerRun run;
            Chain chain;
            chain.draws = drawsOf(gaussian_of_pair, plan);
            run.seconds = fit_seconds + io::cpuSeconds() - fitted_at;
            run.status = chain.draws.rows() > 0 ? "gaussian" : "no_covariance";
            run.chains.chains.push_back(std::move(chain));
            return run;
          }};
}

constexpr int num_burn_in = 500;

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

AccuracyMethod
bayesianMean(const char* name, Preset kind)
{
  const PaperMethod method = preset(name, [kind](Options& options) {
    options.preset = kind;
    options.prior = priorOf(kind);
    options.paper.num_burn_in = num_burn_in;
  });
  return {name, [method](const PaperProblem& problem, const DrawPlan& plan) {
            const SamplerRun run = method.run(problem, plan);
            return AccuracyEstimate{run.summary->mean, run.status};
          }};
}

AccuracyMethod
sgdIcp(const char* name, bool is_one_to_one)
{
  return {name, [is_one_to_one](const PaperProblem& problem, const DrawPlan& plan) {
            StochasticGradientIcpOptions options;
            options.seed = plan.seed;
            options.is_one_to_one = is_one_to_one;
            const TreeSearch search(problem.tree,
                                    std::numeric_limits<double>::infinity());
            const StochasticGradientIcpResult result =
                stochasticGradientIcp(problem.pair.source, search, plan.start, options);
            return AccuracyEstimate{result.pose, toString(result.end)};
          }};
}

AccuracyEstimate
icp(const PaperProblem& problem, const DrawPlan& plan)
{
  MonteCarloIcpOptions options;
  options.mean = plan.start;
  options.half_range.setZero();
  options.num_runs = 1;
  const MonteCarloIcpRun run =
      monteCarloIcp(problem.pair.source, problem.pair.target, options).front();
  return {run.end, toString(run.stop)};
}

} // namespace

std::vector<PaperMethod>
paperMethods()
{
  return {
      preset("bayesian-icp", [](Options& options) { options.preset = Preset::Paper; }),
      preset("bayesian-icp-1e-5",
             [](Options& options) {
               options.preset = Preset::Paper;
               options.paper.sgld.step_size = 1e-5;
             }),
      preset("exact", [](Options& options) { options.preset = Preset::Exact; }),
      preset("calibrated",
             [](Options& options) { options.preset = Preset::Calibrated; }),
      gaussian("online-icp",
               [](const CoverageCase& c) { return planeClosedForm(c, paper_sigma); }),
      gaussian("online-icp-point",
               [](const CoverageCase& c) { return pointClosedForm(c, paper_sigma); }),
      gaussian("online-icp-noise",
               [](const CoverageCase& c) { return planeClosedForm(c, estimated); }),
      gaussian("hessian", pointHessian),
      gaussian("gicp", [](const CoverageCase& c) { return gicpHessian(c); })};
}

PaperMethod
paperMethod(const std::string& name)
{
  const std::vector<PaperMethod> methods = paperMethods();
  const PaperMethod* const found = findNamed(methods, name);
  if (found == nullptr)
    throw std::invalid_argument("no method " + name);
  return *found;
}

std::vector<AccuracyMethod>
accuracyMethods()
{
  return {bayesianMean("paper", Preset::Paper),
          bayesianMean("exact", Preset::Exact),
          bayesianMean("calibrated", Preset::Calibrated),
          sgdIcp("sgd-icp", false),
          sgdIcp("sgd-icp-filter", true),
          {"icp", icp}};
}

} // namespace bayesian_icp::evaluate
