/** \file
 * \brief Clouds of Python as points of the core.
 */
#pragma once

#include <Eigen/Core>

#include <pybind11/pybind11.h>

#include <string>

namespace bayesian_icp::python {

/** \brief Points as the core takes them. */
struct Points {
  /** 3 x n, finite [m]. */
  Eigen::Matrix3Xd xyz;
  /** Whether they come from less than 64 bits. */
  bool is_rounded = false;
  /** A typical |x|, |y| or |z|, the largest of the three axes [m]. */
  double usual_coordinate = 0.0;
};

/** \brief Copy an array-like of shape (n, 3), of any strides and type of real numbers,
 * or what has such `points` (open3d.geometry.PointCloud).
 * \param[in] name in messages
 * \throws pybind11::type_error, pybind11::value_error with the name and what is wrong
 */
Points
pointsOf(pybind11::handle cloud, const std::string& name);

} // namespace bayesian_icp::python
