#include "algebra/decompositions.h"
#include "calibrated/curvature/curvature.h"
#include "calibrated/score/score_clusters.h"
#include "geometry/twist.h"
#include "methods/published_covariances.h"

#include <algorithm>

namespace bayesian_icp::evaluate {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr int num_rounds = 2;

/** Length of a step in posterior, and at most in prior, standard deviations. */
constexpr double step_to_posterior_sd = 3.0;
constexpr double max_step_to_prior_sd = 1.5;

/** The noise of a secant is debited as it is expected to be, and this much less than
 * its 99.9 % quantile where it is of full rank. */
constexpr double quantile_to_debit = 2.807;

/** Scores J^T r of the points, one per column. */
Matrix6Xd
scoresOf(const MatchedPoints& matches, const Vector3d& centre)
{
  Matrix6Xd scores(6, matches.moved.cols());
  for (Index i = 0; i < scores.cols(); ++i) {
    const Vector3d arm = matches.moved.col(i) - centre;
    const Vector3d residual = matches.moved.col(i) - matches.target.col(i);
    scores.col(i) << residual, arm.cross(residual);
  }
  return scores;
}

/** Every coordinate of a residual as a measurement of its own, three a point. */
PointScores
coordinateScores(const BaselineProblem& problem,
                 const MatchedPoints& matches,
                 const Vector3d& centre)
{
  const Index num_points = matches.moved.cols();
  PointScores points;
  points.scores.resize(6, 3 * num_points);
  points.jacobians.resize(6, 3 * num_points);
  points.positions.resize(3, 3 * num_points);
  for (Index i = 0; i < num_points; ++i)
    for (int k = 0; k < 3; ++k) {
      const Index column = 3 * i + k;
      const Vector3d arm = matches.moved.col(i) - centre;
      points.jacobians.col(column) << Vector3d::Unit(k), arm.cross(Vector3d::Unit(k));
      points.scores.col(column) =
          points.jacobians.col(column) * (matches.moved(k, i) - matches.target(k, i));
      points.positions.col(column) = problem.source.col(i);
    }
  return points;
}

/** J: half the shape of clusters, half that of independent points, in the size of 24
 * clusters. */
Matrix6d
scoreCovarianceOf(const PointScores& points,
                  const Matrix6Xd& scores,
                  const Matrix6d& working_information)
{
  const auto clustered = [&](int num_clusters, int num_partitions) {
    ClusterOptions options;
    options.num_clusters = num_clusters;
    options.num_partitions = num_partitions;
    options.stream = static_cast<std::uint64_t>(num_clusters);
    return clusteredCovariance(points, working_information, options);
  };
  const Matrix6d independent = scores * scores.transpose();
  const Eigen::LDLT<Matrix6d> metric(independent);
  const auto kappa = [&](const Matrix6d& J) { return metric.solve(J).trace() / 6.0; };
  const Matrix6d J_48 = clustered(48, 6);
  const double kappa_24 = kappa(clustered(24, 12));
  return 0.5 * kappa_24 * (J_48 / kappa(J_48) + independent);
}

/** Measures secants at the fit. */
class SecantMaker {
public:
  SecantMaker(const BaselineProblem& problem, const IcpFit& fit, double noise)
  : problem_(problem)
  , fit_(fit)
  , centre_(problem.centreAt(fit.pose))
  , noise_(noise)
  , prior_precision_(twistPrior(problem.prior, fit.pose, centre_).precision)
  , metric_(gaussNewton(fit.matches, centre_).hessian /
            double(fit.matches.moved.cols()))
  {}

  /** \param[in] covariance its principal axes are the directions */
  Secants
  measure(const Matrix6d& covariance) const
  {
    const Matrix6d L = metric_.llt().matrixL();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(
        Matrix6d(L.transpose() * covariance * L));
    Secants secants;
    for (int k = 0; k < 6; ++k) {
      const Vector6d axis = L.transpose().triangularView<Eigen::Upper>().solve(
          Vector6d(solver.eigenvectors().col(k)));
      const double sd = std::sqrt(std::max(0.0, solver.eigenvalues()[k]));
      measureAlong(lengthOf(axis, sd) * axis, k, secants);
    }
    const Matrix6d products = secants.steps.transpose() * secants.differences;
    const Matrix6d inverse = secants.steps.inverse();
    secants.curvature =
        inverse.transpose() * (0.5 * (products + products.transpose())) * inverse;
    return secants;
  }

  /** The same step, of the noise's length, in all directions. */
  Matrix6d
  firstCovariance() const
  {
    return noise_ * noise_ * metric_.inverse();
  }

  const Matrix6d&
  priorPrecision() const
  {
    return prior_precision_;
  }

private:
  double
  lengthOf(const Vector6d& axis, double standard_deviation) const
  {
    const double longest =
        max_step_to_prior_sd / std::sqrt(axis.dot(prior_precision_ * axis));
    return std::min(longest,
                    std::max(noise_, step_to_posterior_sd * standard_deviation));
  }

  Matrix6Xd
  scoresAt(const Vector6d& step) const
  {
    return scoresOf(problem_.match(movedBy(step, centre_, fit_.pose)), centre_);
  }

  void
  measureAlong(const Vector6d& step, int direction, Secants& secants) const
  {
    PointScores points;
    points.scores = 0.5 * (scoresAt(step) - scoresAt(-step));
    points.positions = problem_.source;
    ClusterOptions options;
    options.num_partitions = 3;
    options.stream = 1000 + static_cast<std::uint64_t>(direction);
    secants.steps.col(direction) = step;
    secants.differences.col(direction) = points.scores.rowwise().sum();
    secants.noise[static_cast<std::size_t>(direction)] =
        clusteredCovariance(points, Matrix6d::Zero(), options) / quantile_to_debit;
  }

  const BaselineProblem& problem_;
  const IcpFit& fit_;
  Vector3d centre_;
  double noise_;
  Matrix6d prior_precision_;
  Matrix6d metric_;
};

} // namespace

GaussianInformation
pointToPointSandwich(const BaselineProblem& problem, const IcpFit& fit, double noise)
{
  const Vector3d centre = problem.centreAt(fit.pose);
  const GaussNewton sums = gaussNewton(fit.matches, centre);
  const SecantMaker maker(problem, fit, noise);
  const Matrix6d J =
      scoreCovarianceOf(coordinateScores(problem, fit.matches, centre),
                        scoresOf(fit.matches, centre),
                        sums.hessian + fit.variance * maker.priorPrecision());
  Matrix6d covariance = maker.firstCovariance();
  GaussianInformation result;
  for (int round = 0; round < num_rounds; ++round) {
    const Secants secants = maker.measure(covariance);
    const DebitedInformation debited = debitedInformation(secants, J, Vector6d::Zero());
    result.information = debited.information;
    result.gradient = debited.transfer.transpose() * secants.curvature *
                      J.ldlt().solve(sums.gradient);
    covariance = (result.information + maker.priorPrecision()).inverse();
  }
  return result;
}

} // namespace bayesian_icp::evaluate
