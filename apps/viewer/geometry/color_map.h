/** \file
 * \brief Lengths as colours and as text.
 */
#pragma once

#include <Eigen/Core>

#include <array>
#include <string>

namespace bayesian_icp::viewer {

/** \brief Red, green, blue in [0, 1]. */
using Color = std::array<double, 3>;

/** \brief The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is
 * not less than \p value; 1e-6 for what is not positive. */
double
niceMaximum(double value);

/** \brief How many times larger deviations are to be drawn so that the largest is at
 * most a twentieth of \p size: the largest of 1, 2, 5, 10, ... 1000 that does it, or 1.
 * \param[in] largest_deviation, size [m] */
double
niceMagnification(double largest_deviation, double size);

/** \brief The unit in which lengths of this size are written. */
struct LengthUnit {
  const char* name;
  double in_metres;
};

/** \brief Millimetres below 0.1 m, metres from there on. */
LengthUnit
unitFor(double length);

/** \brief Three lengths [m] in one unit with three digits: "1.2, 0.8, 0.04 mm". */
std::string
textOfLengths(const Eigen::Vector3d& lengths);

/** \brief Three angles [rad] in degrees with three digits: "20, 0.1, 0.09 deg". */
std::string
textOfAngles(const Eigen::Vector3d& angles);

} // namespace bayesian_icp::viewer
