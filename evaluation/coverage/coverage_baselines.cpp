#include "calibrated/surface/surface_model.h"
#include "coverage/coverage_methods.h"
#include "methods/baseline_problem.h"
#include "methods/published_covariances.h"

namespace bayesian_icp::evaluate {

namespace {

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

} // namespace bayesian_icp::evaluate
