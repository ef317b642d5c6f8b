/** \file
 * \brief Internal: points of a cloud that cover it evenly.
 */
#pragma once

#include <bayesian_icp/random.h>

#include <Eigen/Core>

#include <vector>

namespace bayesian_icp {

/** \brief Put columns into a random order. */
void
shuffle(std::vector<Eigen::Index>& columns, Random& random);

/** \brief Columns of points that cover a cloud evenly, ascending: one, chosen at
 * random, of each cube of a grid whose cubes are such that nearly \p count of them hold
 * points; all columns if there are no more than that.
 * \param[in] points 3 x n, finite
 * \param[in] count most columns, at least 1 */
std::vector<Eigen::Index>
evenChoice(const Eigen::Matrix3Xf& points, Eigen::Index count);

/** \brief Columns of about \p count points, ascending: each is taken with a probability
 * inversely proportional to the number of points around it, but at most 1; all columns
 * if there are no more than \p count.
 *
 * Dense parts become as sparse as the rest, but neighbours keep their proportions. One
 * point of each cube would not do that where cubes are smaller than the noise: too many
 * of the points would be from the noise's tails, and surfaces through them tilted.
 * \param[in] points 3 x n, finite
 * \param[in] count at least 1 */
std::vector<Eigen::Index>
evenlyThinned(const Eigen::Matrix3Xf& points, Eigen::Index count);

} // namespace bayesian_icp
