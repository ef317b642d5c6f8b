/** \file
 * \brief Internal: points of a cloud that cover it evenly.
 */
#pragma once

#include <bayesian_icp/random.h>

#include <Eigen/Core>

#include <vector>

namespace bayesian_icp {

/** \brief Root mean square distance of points from their centroid [m].
 * \param[in] points 3 x n, at least one */
double
spreadOf(const Eigen::Matrix3Xf& points);

/** \brief Diagonal of the bounding box [m].
 * \param[in] points 3 x n, at least one */
double
extentOf(const Eigen::Matrix3Xd& points);

/** \brief Put columns into a random order. */
void
shuffle(std::vector<Eigen::Index>& columns, Random& random);

/** \brief Purpose of a choice: points that get a patch, or points that are compared
 * with the patches of the other cloud. The random choice depends on the indices of the
 * points. With one stream for both purposes, the same rays would be chosen from two
 * scans of a sensor that stands still. */
enum class ChoiceStream { Patches, Points };

/** \brief Columns of points that cover a cloud evenly, ascending: a random point of
 * each cube of a grid. The size of the cubes is such that nearly \p count of them hold
 * points. The grid is tilted, because cubes parallel to a wall would cut off more of
 * the noise's tail on one side of it. Choices of one stream for several counts have
 * many points in common. Returns all columns if there are no more than \p count.
 * \param[in] points 3 x n, finite
 * \param[in] count maximum number of columns, at least 1
 * \param[in] stream of the random choice */
std::vector<Eigen::Index>
evenChoice(Eigen::Matrix3Xf points, Eigen::Index count, ChoiceStream stream);

/** \brief Columns of the points that are not stray, ascending. Dust, rain and stray
 * measurements fill space, and an even choice would prefer them to surfaces. A point is
 * isolated if there are fewer than 5 points around it, where an even sheet of all
 * points (of \p count if there are more) has about 92. Isolated points are stray if
 * they are more than those with 5 to 19 points around them. Otherwise they are where
 * the cloud gets sparse, as the far points of a LiDAR are. \param[in] points 3 x n,
 * finite, at least one \param[in] count at least 1 */
std::vector<Eigen::Index>
withoutStray(const Eigen::Matrix3Xf& points, Eigen::Index count);

/** \brief Columns of about \p count points, ascending. Each point is taken with a
 * probability that is inversely proportional to the number of points around it, but at
 * most 1. Returns all columns if there are no more than \p count.
 *
 * Dense parts become as sparse as the rest, and the distribution of the noise does not
 * change. Choosing one point of each cube would change it where cubes are smaller than
 * the noise: too many points would come from the tails of the noise, and surfaces
 * through them would be tilted.
 *
 * \param[in] points 3 x n, finite
 * \param[in] count at least 1 */
std::vector<Eigen::Index>
evenlyThinned(const Eigen::Matrix3Xf& points, Eigen::Index count);

} // namespace bayesian_icp
