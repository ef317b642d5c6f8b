// A calibrated estimate that no clouds are behind: scores that are linear in the pose,
// with errors of their own at every point.
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

namespace bayesian_icp::test {

/** n points of which each measures one random direction of the pose. */
struct StandIn {
  struct Options {
    /** Standard deviation of what new correspondences do to a point's residual. Their
     * effect on the total score is zero. */
    double noise = 0.5;
    /** Standard deviations of x, y, z [m], of roll and pitch, and of yaw [rad]. */
    double prior_translation = 0.002;
    double prior_tilt = 0.02;
    double prior_yaw = 0.02;
    /** Whether no point measures the yaw about centre. */
    bool is_yaw_free = false;
  };

  explicit StandIn(const Options& options)
  : noise(num_points)
  , prior(makePrior(options))
  {
    Random random(31, 0);
    Matrix6Xd jacobians(6, num_points);
    Eigen::VectorXd residuals(num_points);
    for (Eigen::Index i = 0; i < num_points; ++i) {
      jacobians.col(i) = 100.0 * random.normal6().cwiseQuotient(directionLengths());
      residuals[i] = random.normal();
      noise[i] = options.noise * random.normal();
      if (options.is_yaw_free)
        jacobians(5, i) = 0.0;
    }
    const Matrix6d information = jacobians * jacobians.transpose();
    noise -= jacobians.transpose() *
             information.completeOrthogonalDecomposition().solve(jacobians * noise);
    setEstimate(options, jacobians, residuals);
  }

  /** z = (b) or (a, b) counts in these units, sd of the posterior of about 0.001. */
  static Vector6d
  directionLengths()
  {
    return {1.0, 1.0, 1.0, 10.0, 10.0, 10.0};
  }

  static Eigen::Isometry3d
  mode()
  {
    return isometryOf({0.4, -0.3, 0.8, 0.1, -0.2, 0.5});
  }

  static Eigen::Vector3d
  centre()
  {
    return {1.0, 2.0, 0.5};
  }

  /** The scores of points moved from the mode. */
  BatchScore
  score() const
  {
    return [this](const CalibratedEstimate&,
                  const Eigen::Isometry3d& pose,
                  const std::vector<std::size_t>& indices,
                  PatchHints&,
                  Vector6d& total) {
      const Vector6d xi = twistBetween(estimate.mode, pose, estimate.centre);
      total.setZero();
      for (const std::size_t index : indices) {
        const auto i = static_cast<Eigen::Index>(index);
        const auto jacobian = estimate.scores.jacobians.col(i);
        total +=
            estimate.scores.scores.col(i) + jacobian * (noise[i] + jacobian.dot(xi));
      }
      return static_cast<int>(indices.size());
    };
  }

  static constexpr Eigen::Index num_points = 400;
  Eigen::VectorXd noise;
  Prior prior;
  CalibratedEstimate estimate;

private:
  static Prior
  makePrior(const Options& options)
  {
    const double length = options.prior_translation, tilt = options.prior_tilt;
    const Vector6d sd(length, length, length, tilt, tilt, options.prior_yaw),
        offset(0.5, -0.3, 0.8, -0.6, 0.4, 0.3);
    const Eigen::Vector3d reference = mode().inverse() * centre();
    Vector6d mean = poseOf(mode().matrix()) + offset.cwiseProduct(sd);
    // The offset is that of the reference point, wherever the mean turns it.
    mean.head<3>() = centre() - rotationOf(mean) * reference +
                     offset.head<3>().cwiseProduct(sd.head<3>());
    return Prior(mean, sd.cwiseAbs2(), reference);
  }

  void
  setEstimate(const Options& options,
              const Matrix6Xd& jacobians,
              const Eigen::VectorXd& residuals)
  {
    CalibratedEstimate& e = estimate;
    e.mode = mode();
    e.centre = centre();
    SurfaceScores& scores = e.scores;
    scores.residuals = residuals;
    scores.active.assign(num_points, 1);
    scores.has_patch.assign(num_points, 1);
    scores.num_active = static_cast<int>(num_points);
    scores.jacobians = jacobians;
    scores.scores = jacobians * residuals.asDiagonal();
    scores.total = scores.scores.rowwise().sum();
    scores.information = jacobians * jacobians.transpose();
    e.curvature = scores.information;
    // Points that are four times as uncertain, together, as each of them looks.
    e.score_covariance = 4.0 * scores.information + Matrix6d::Identity();
    e.directions = directionLengths().asDiagonal();
    e.keep = Vector6d::Ones();
    e.keep[5] = options.is_yaw_free ? 0.0 : 1.0;
    e.transfer = e.keep.asDiagonal();
    const Eigen::LDLT<Matrix6d> J(e.score_covariance);
    e.information = e.curvature * J.solve(e.curvature);
    e.prior = twistPrior(prior, e.mode, e.centre);
    e.covariance = (e.information + e.prior.precision).inverse();
    e.mean = -e.covariance * (e.curvature * J.solve(scores.total) + e.prior.gradient);
  }
};

} // namespace bayesian_icp::test
