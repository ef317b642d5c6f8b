#include "methods/published_covariances.h"

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

/** \p sigma, or if that is NaN \p estimate. */
double
sigmaOr(double sigma, double estimate)
{
  return std::isnan(sigma) ? estimate : sigma;
}

} // namespace

PlaneFit
fitPlanes(const BaselineProblem& problem)
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
  return {fit, std::sqrt(0.5 * variance)};
}

TwistGaussian
pointClosedForm(const CoverageCase& coverage_case, double sigma)
{
  const BaselineProblem problem(coverage_case, coverage_case.source.cols());
  double variance = 0.0;
  const IcpFit fit = fitNaively(problem, variance);
  const Vector3d centre = problem.centreAt(fit.pose);
  // The noise of a difference is that of two points.
  return {fit.pose,
          closedFormCovariance(closedFormDerivatives(fit.matches, centre),
                               sigmaOr(sigma, std::sqrt(0.5 * variance))),
          centre};
}

TwistGaussian
planeClosedForm(const CoverageCase& coverage_case, double sigma, Index max_points)
{
  const BaselineProblem problem(
      coverage_case, max_points > 0 ? max_points : coverage_case.source.cols());
  const PlaneFit planes = fitPlanes(problem);
  const Vector3d centre = problem.centreAt(planes.fit.pose);
  return {planes.fit.pose,
          closedFormCovariance(closedFormDerivatives(planes.fit.matches, centre),
                               sigmaOr(sigma, planes.sigma)),
          centre};
}

TwistGaussian
pointHessian(const CoverageCase& coverage_case)
{
  const BaselineProblem problem(coverage_case, coverage_case.source.cols());
  double variance = 0.0;
  const IcpFit fit = fitNaively(problem, variance);
  const Vector3d centre = problem.centreAt(fit.pose);
  return {
      fit.pose,
      hessianCovariance(gaussNewton(fit.matches, centre).hessian, std::sqrt(variance)),
      centre};
}

TwistGaussian
gicpHessian(const CoverageCase& coverage_case, Index max_points)
{
  const BaselineProblem problem(coverage_case, max_points);
  const GicpFit gicp = fitPclGicp(problem.ofPcl());
  const Vector3d centre = problem.centreAt(gicp.fit.pose);
  return {gicp.fit.pose,
          hessianCovariance(generalizedIcpHessian(gicp.moved, gicp.covariances, centre),
                            1.0),
          centre};
}

} // namespace bayesian_icp::evaluate
