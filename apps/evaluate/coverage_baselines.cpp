#include "coverage_baselines.h"

#include "baseline_problem.h"
#include "pcl_baselines.h"
#include "point_to_point_sandwich.h"

#include <bayesian_icp/calibration/surface_model.h>

#include <Eigen/Eigenvalues>

#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

constexpr Index num_plane_neighbors = 15;

/** Normals of the planes through the nearest points of each, itself included. */
Matrix3Xd
planeNormals(const Matrix3Xd& points)
{
  using Tree = nanoflann::
      KDTreeEigenMatrixAdaptor<Matrix3Xd, 3, nanoflann::metric_L2_Simple, false>;
  const Tree tree(3, std::cref(points));
  const Index count = std::min(num_plane_neighbors, points.cols());
  std::vector<Index> nearest(static_cast<std::size_t>(count));
  std::vector<double> squared_distances(nearest.size());
  Matrix3Xd normals(3, points.cols());
  for (Index i = 0; i < points.cols(); ++i) {
    const Vector3d query = points.col(i);
    tree.query(query.data(), nearest.size(), nearest.data(), squared_distances.data());
    Matrix3Xd neighbors(3, count);
    for (Index k = 0; k < count; ++k)
      neighbors.col(k) = points.col(nearest[static_cast<std::size_t>(k)]);
    neighbors.colwise() -= Vector3d(neighbors.rowwise().mean());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(neighbors *
                                                                neighbors.transpose());
    normals.col(i) = solver.eigenvectors().col(0);
  }
  return normals;
}

/** Robust standard deviation of the distances to the planes [m]. */
double
planeResidualScale(const MatchedPoints& matches)
{
  std::vector<double> distances;
  for (Index i = 0; i < matches.moved.cols(); ++i)
    distances.push_back(std::abs(
        matches.normals.col(i).dot(matches.moved.col(i) - matches.target.col(i))));
  const auto middle =
      distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return 1.4826 * *middle;
}

MethodResult
naive(const BaselineProblem& problem)
{
  double variance = 0.0;
  const IcpFit fit = fitNaively(problem, variance);
  const GaussNewton sums = gaussNewton(fit.matches, problem.centreAt(fit.pose));
  return problem.combineWithPrior(fit.pose,
                                  {sums.hessian / variance, sums.gradient / variance});
}

MethodResult
closedForm(const BaselineProblem& problem)
{
  double variance = 0.0;
  IcpFit fit = fitNaively(problem, variance);
  IcpCost cost;
  cost.normals = planeNormals(problem.target());
  // A few steps by the naive scale, the rest by the planes' own.
  for (const int max_steps : {30, 10}) {
    cost.weight = 1.0 / variance;
    cost.max_steps = max_steps;
    fit = fitIcp(problem, cost, fit.pose);
    variance = std::pow(planeResidualScale(fit.matches), 2);
  }
  // The noise of a distance is that of two points.
  const double sigma = std::sqrt(0.5 * variance);
  const auto derivatives =
      closedFormDerivatives(fit.matches, problem.centreAt(fit.pose));
  return problem.combineWithPrior(fit.pose, closedFormInformation(derivatives, sigma));
}

MethodResult
sandwich(const BaselineProblem& problem)
{
  double variance = 0.0;
  const IcpFit fit = fitNaively(problem, variance);
  const double noise =
      SurfaceModel(problem.target(), SurfaceModelOptions(), 1).medianSigma();
  return problem.combineWithPrior(fit.pose,
                                  pointToPointSandwich(problem, fit, variance, noise));
}

/** The registration of a case by PCL. */
PclProblem
pclProblem(const CoverageCase& coverage_case, const BaselineProblem& problem)
{
  return {coverage_case.source,
          coverage_case.target,
          problem.sourceColumns(),
          problem.priorMean()};
}

MethodResult
gicp(const CoverageCase& coverage_case, const BaselineProblem& problem)
{
  const GicpFit gicp = fitPclGicp(pclProblem(coverage_case, problem));
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

MethodResult
icp(const CoverageCase& coverage_case, const BaselineProblem& problem)
{
  const PclFit fit = fitPclIcp(pclProblem(coverage_case, problem));
  MethodResult result = problem.combineWithPrior(fit.pose, GaussianInformation());
  result.mean = fit.pose;
  result.num_queries = -1;
  result.notes = fit.has_converged ? "pose only" : "pose only;not converged";
  return result;
}

using Baseline =
    std::function<MethodResult(const CoverageCase&, const BaselineProblem&)>;

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
            return baseline(coverage_case, BaselineProblem(coverage_case));
          }};
}

/** A baseline that needs only the problem. */
Baseline
ofProblem(MethodResult (*run)(const BaselineProblem&))
{
  return [run](const CoverageCase&, const BaselineProblem& problem) {
    return run(problem);
  };
}

} // namespace

std::vector<CoverageMethod>
baselineMethods()
{
  return {method("naive", ofProblem(naive)),
          method("closed-form", ofProblem(closedForm)),
          method("point-to-point-sandwich", ofProblem(sandwich)),
          method("gicp", gicp),
          method("icp", icp)};
}

} // namespace bayesian_icp::evaluate
