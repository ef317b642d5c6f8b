/** \file
 * \brief The initial guess as users give it: a pose in words, or a file with a matrix.
 */
#pragma once

#include <Eigen/Core>

#include <string>

namespace bayesian_icp::app {

/** \brief What is wrong with \p matrix as a rigid motion; empty if it is one, up to
 * what a few printed digits allow. */
std::string
complaintAboutMotion(const Eigen::Matrix4d& matrix);

/** \brief The rigid motion of a text file with the 16 numbers of its matrix, row by
 * row. \throws io::FileError if the file has something else */
Eigen::Matrix4d
readMatrixFile(const std::string& file);

/** \brief The matrix T_target_source of "x,y,z,roll,pitch,yaw" [m, rad], or of a
 * file as of readMatrixFile(). \throws io::UsageError if it is
 * neither, io::FileError if the file has something else */
Eigen::Matrix4d
readGuess(const std::string& text);

} // namespace bayesian_icp::app
