/** \file
 * \brief The plane in which a 2-D laser scanner moves.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <optional>

namespace bayesian_icp::app {

/** \brief Stated standard deviation of motions out of the sensor's plane, along and
 * about each axis [m, rad]. */
constexpr double out_of_plane_deviation = 1e-3;

/** \brief Motions out of the plane: along its normal, and about two axes in it. */
constexpr int num_motions_out_of_plane = 3;

/** \brief Normal of the plane in which \p points lie, as those of a 2-D laser scanner
 * do; none if they do not. */
std::optional<Eigen::Vector3d>
planeNormalOf(const Eigen::Matrix3Xd& points);

/** \brief What to tell of it. */
constexpr const char* plane_note =
    "note: scan 0 lies in a plane, like that of a 2-D laser scanner, so the trajectory "
    "stays in it";

/** \brief Projection of twists in the sensor's frame to those that stay in its plane;
 * the identity without a plane. */
Matrix6d
projectionToPlane(const std::optional<Eigen::Vector3d>& normal);

/** \brief The covariance of a twist in the sensor's frame for a sensor that stays in
 * its plane: out_of_plane_deviation out of it. As it is, without a plane.
 *
 * \param[in] to_plane projectionToPlane() */
Matrix6d
keptInPlane(const Matrix6d& covariance, const Matrix6d& to_plane);

} // namespace bayesian_icp::app
