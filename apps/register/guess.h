/** \file
 * \brief The initial guess as users give it: a pose in words, or a file with a matrix.
 */
#pragma once

#include <Eigen/Core>

#include <string>

namespace bayesian_icp::app {

/** \brief The matrix T_target_source of "x,y,z,roll,pitch,yaw" [m, rad], or of a text
 * file with the 16 numbers of the matrix row by row. \throws io::UsageError if it is
 * neither, io::FileError if the file has something else */
Eigen::Matrix4d
readGuess(const std::string& text);

} // namespace bayesian_icp::app
