/** \file
 * \brief A case of the coverage study as the baselines see it: nearest neighbours,
 * ICP with a prior, and how their information is combined with the prior's.
 */
#pragma once

#include "baselines/covariances.h"
#include "methods/pcl_baselines.h"
#include "study/coverage_case.h"

#include <bayesian_icp/kd_tree.h>
#include <bayesian_icp/prior.h>

#include <cmath>

namespace bayesian_icp::evaluate {

/** \brief Largest number of source points that are registered, unless stated otherwise.
 */
constexpr Eigen::Index max_source_points = 2000;

class BaselineProblem {
public:
  /** \param[in] registered must outlive this object; not empty */
  explicit BaselineProblem(const CoverageCase& registered,
                           Eigen::Index max_points = max_source_points);

  const CoverageCase& coverage_case;
  /** The points that are registered, columns of the case's source: a random choice, all
   * if they are few. */
  const std::vector<Eigen::Index> source_columns;
  const Eigen::Matrix3Xd source;
  const Prior prior;

  /** \brief Nearest target point of each source point, without normals. Not
   * thread-safe: it counts. */
  MatchedPoints
  match(const Eigen::Isometry3d& T_target_source) const;

  /** \brief Centre of the twists at a pose: the moved centroid of all source points.
   */
  Eigen::Vector3d
  centreAt(const Eigen::Isometry3d& T_target_source) const
  {
    return T_target_source * prior.referencePoint();
  }

  /** \brief The posterior whose likelihood has this information about a pose, and
   * whose energy has this gradient there: one Newton step. */
  MethodResult
  combineWithPrior(const Eigen::Isometry3d& T_target_source,
                   const GaussianInformation& likelihood) const;

  Eigen::Isometry3d
  priorMean() const;

  /** \brief The registration by PCL, from the prior's mean. */
  PclProblem
  ofPcl() const
  {
    return {coverage_case.source, coverage_case.target, source_columns, priorMean()};
  }

private:
  /** The tree is in single precision: its points are relative to this one. */
  Eigen::Vector3d origin_;
  KdTree tree_;
  mutable std::vector<std::uint32_t> hints_;
  mutable long num_queries_ = 0;
};

/** \brief Where ICP with the prior ended. */
struct IcpFit {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  /** There, and with normals if it used any. */
  MatchedPoints matches;
  /** Naive one of a residual's coordinate [m^2]. */
  double variance = 0.0;

  /** \brief Noise of a point's coordinate [m]: that of a residual is of two points. */
  double
  pointSigma() const
  {
    return std::sqrt(0.5 * variance);
  }
};

/** \brief What ICP minimises besides the prior's energy. */
struct IcpCost {
  /** Factor on half the sum of squared residuals [1/m^2]. */
  double weight = 0.0;
  /** Of the target, 3 x n: point to plane; empty: point to point. */
  Eigen::Matrix3Xd normals;
  int max_steps = 40;
};

/** \brief Gauss-Newton with correspondences made anew before each step; the variance is
 * left to others. */
IcpFit
fitIcp(const BaselineProblem& problem,
       const IcpCost& cost,
       const Eigen::Isometry3d& start);

/** \brief Point-to-point ICP with the prior, weighted by its own residuals. */
IcpFit
fitNaively(const BaselineProblem& problem);

} // namespace bayesian_icp::evaluate
