/** \file
 * \brief A cloud without its repetitions.
 */
#pragma once

#include <Eigen/Core>

namespace bayesian_icp {

/** \brief The finite points of a cloud, each once, in their order. Merged clouds often
 * have points twice, whose spacing and noise of zero say nothing about a surface.
 * \param[in] points 3 x n [m]
 * \return 3 x m [m] */
Eigen::Matrix3Xd
distinctPoints(const Eigen::Matrix3Xd& points);

} // namespace bayesian_icp
