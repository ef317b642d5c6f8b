/** \file
 * \brief Internal: points of a cloud that cover it evenly.
 */
#pragma once

#include <Eigen/Core>

#include <vector>

namespace bayesian_icp {

/** \brief Columns of points that cover a cloud evenly, ascending: one, chosen at
 * random, of each cube of a grid whose cubes are such that nearly \p count of them hold
 * points; all columns if there are no more than that. \param[in] points 3 x n, finite
 * \param[in] count most columns, at least 1 */
std::vector<Eigen::Index>
evenChoice(const Eigen::Matrix3Xf& points, Eigen::Index count);

} // namespace bayesian_icp
