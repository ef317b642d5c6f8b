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

/** \brief What points are chosen for: to get a patch, or to be compared with the
 * patches of the other cloud. The random choice depends on the points' numbers: with
 * one stream for both, the same rays of a standing sensor would be chosen from its two
 * scans. */
enum class ChoiceStream { Patches, Points };

/** \brief Columns of points that cover a cloud evenly, ascending: a random point of
 * each cube of a grid. The cubes are so large that nearly \p count of them hold points.
 * The grid is tilted: if cubes were parallel to a wall, they would cut off more of the
 * noise's tail on one side of it.
 * Choices of one stream for several counts have many points in common. All columns if
 * there are no more than \p count.
 * \param[in] points 3 x n, finite
 * \param[in] count most columns, at least 1
 * \param[in] stream of the random choice */
std::vector<Eigen::Index>
evenChoice(const Eigen::Matrix3Xf& points, Eigen::Index count, ChoiceStream stream);

/** \brief Columns of about \p count points, ascending. Each point is taken with a
 * probability that is inversely proportional to the number of points around it, but at
 * most 1. All columns if there are no more than \p count.
 *
 * Dense parts become as sparse as the rest, and the distribution of the noise stays.
 * One point of each cube would change it where cubes are smaller than the noise: too
 * many points would be from the noise's tails, and surfaces through them would be
 * tilted.
 *
 * \param[in] points 3 x n, finite
 * \param[in] count at least 1 */
std::vector<Eigen::Index>
evenlyThinned(const Eigen::Matrix3Xf& points, Eigen::Index count);

} // namespace bayesian_icp
