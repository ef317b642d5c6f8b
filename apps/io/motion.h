/** \file
 * \brief A rigid motion as users give it: a pose in words, or a file with a matrix.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <Eigen/Core>

#include <string>

namespace bayesian_icp::io {

/** \brief What is wrong with \p matrix as a rigid motion; empty if it is one, up to
 * what a few printed digits allow. */
std::string
complaintAboutMotion(const Eigen::Matrix4d& matrix);

/** \brief The rigid motion in a text file with the 16 numbers of its 4x4 matrix row by
 * row.
 * \throws FileError if the file has something else */
Eigen::Matrix4d
readMatrixFile(const std::string& file);

/** \brief The matrix of a file as readMatrixFile() takes it, or of the mean of a
 * posterior.json (a name that ends in .json).
 * \throws FileError if the file has something else */
Eigen::Matrix4d
readMotionFile(const std::string& file);

/** \brief Whether no angle of (x, y, z, roll, pitch, yaw) is above 2 pi. One that is
 * has been written in degrees. */
bool
areAnglesWithinATurn(const Vector6d& pose);

/** \brief The matrix of "x,y,z,roll,pitch,yaw" [m, rad], or of a file as
 * readMotionFile() takes it.
 * \param[in] option its name in errors, without the dashes
 * \throws UsageError if it is none of them, not finite or in degrees, FileError if the
 * file has something else */
Eigen::Matrix4d
readMotion(const std::string& option, const std::string& text);

} // namespace bayesian_icp::io
