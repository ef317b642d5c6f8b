/** \file
 * \brief How much larger one cloud is than another, like a map than a scan.
 */
#pragma once

#include <bayesian_icp/prior.h>

#include <limits>
#include <vector>

namespace bayesian_icp {

/** \brief How many times the number of patches of \p cloud is doubled, because only a
 * part of it meets \p other: once if it occupies four times as much space, twice for
 * eight times, at most max_doublings times.
 * \param[in] cloud 3 x n [m]
 * \param[in] other 3 x n [m], points that are not finite are skipped */
int
numDoublings(const Eigen::Matrix3Xd& cloud, const Eigen::Matrix3Xd& other);

constexpr int max_doublings = 3;

/** \brief A ball in the target frame that holds the points of a source, wherever the
 * prior lets them be. */
struct Reach {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /** [m] */
  double radius = std::numeric_limits<double>::infinity();
};

/** \brief The reach of some columns of \p source.
 * \param[in] source 3 x n, source frame [m]
 * \param[in] columns of finite points, at least one */
Reach
reachOf(const Eigen::Matrix3Xd& source,
        const std::vector<Eigen::Index>& columns,
        const Prior& prior);

/** \brief The \p columns of \p target that are within reach, or all of them if few are.
 * \param[in] target 3 x n, target frame [m]
 * \param[in] columns of finite points */
std::vector<Eigen::Index>
columnsWithin(const Reach& reach,
              const Eigen::Matrix3Xd& target,
              const std::vector<Eigen::Index>& columns);

} // namespace bayesian_icp
