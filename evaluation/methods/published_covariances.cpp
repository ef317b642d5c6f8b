#include "methods/published_covariances.h"

#include "sampler/median.h"

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
  return 1.4826 * bayesian_icp::medianOf(distances);
}

/** \param[in] sigma noise of a point's coordinate [m]; NaN: that of the fit */
TwistGaussian
closedForm(const BaselineProblem& problem, const IcpFit& fit, double sigma)
{
  const Vector3d centre = problem.centreAt(fit.pose);
  return {fit.pose,
          closedFormCovariance(closedFormDerivatives(fit.matches, centre),
                               std::isnan(sigma) ? fit.pointSigma() : sigma),
          centre};
}

} // namespace

IcpFit
fitPlanes(const BaselineProblem& problem)
{
  IcpFit fit = fitNaively(problem);
  double variance = fit.variance;
  IcpCost cost;
  cost.normals = planeNormals(problem.coverage_case.target);
  // A few steps by the naive scale, the rest by the planes' own.
  for (const int max_steps : {30, 10}) {
    cost.weight = 1.0 / variance;
    cost.max_steps = max_steps;
    fit = fitIcp(problem, cost, fit.pose);
    variance = std::pow(planeResidualScale(fit.matches), 2);
  }
  fit.variance = variance;
  return fit;
}

TwistGaussian
pointClosedForm(const CoverageCase& coverage_case, double sigma)
{
  const BaselineProblem problem(coverage_case, coverage_case.source.cols());
  return closedForm(problem, fitNaively(problem), sigma);
}

TwistGaussian
planeClosedForm(const CoverageCase& coverage_case, double sigma, Index max_points)
{
  const BaselineProblem problem(
      coverage_case, max_points > 0 ? max_points : coverage_case.source.cols());
  return closedForm(problem, fitPlanes(problem), sigma);
}

TwistGaussian
pointHessian(const CoverageCase& coverage_case)
{
  const BaselineProblem problem(coverage_case, coverage_case.source.cols());
  const IcpFit fit = fitNaively(problem);
  const Vector3d centre = problem.centreAt(fit.pose);
  return {fit.pose,
          hessianCovariance(gaussNewton(fit.matches, centre).hessian,
                            std::sqrt(fit.variance)),
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
