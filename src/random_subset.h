/** \file
 * \brief A random choice of points.
 */
#pragma once

#include <Eigen/Core>

#include <cstdint>

namespace bayesian_icp {

/** \brief At most \p max_points of the points, chosen at random, in a random order:
 * any part of the result is a random choice as well. */
Eigen::Matrix3Xd
randomSubset(const Eigen::Matrix3Xd& points, int max_points, std::uint64_t seed);

} // namespace bayesian_icp
