/** \file
 * \brief The table that pcl_bayesian_icp prints, and its parts, columns and lines.
 */
#pragma once

#include "register/run.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief Pose, deviation, interval and diagnostics with units, the status in words,
 * and matrices in the form that pcl_transform_point_cloud takes. */
std::string
reportText(const Run& run);

/** \brief The coordinates of the mean pose T_mean, which is a pose of the posterior
 * also where the separate means of the coordinates are not [m, rad]. An angle is
 * unwrapped about its own mean, as its quantiles are. */
Vector6d
meanPoseCoordinates(const Summary& summary);

/** \brief The table of the coordinates: mean pose, deviation, interval and diagnostics
 * of each [m, rad], then the first four of the angles in degrees. The first cell of a
 * row is the coordinate's name with its unit. \param[in] degree name of that unit
 * \param[in] unknown stands for numbers that are not finite */
std::vector<std::vector<std::string>>
coordinateCells(const Summary& summary,
                const std::string& degree,
                const std::string& unknown);

/** \brief A coordinate's name, and its unit: [m], or for angles \p unit_of_angles. */
std::string
nameWithUnit(int coordinate, const std::string& unit_of_angles);

/** \brief Whether ICP has converged, and the distance that it leaves. */
std::string
icpText(const RegistrationResult& result);

/** \brief What there is to know before ICP's result is used: that ICP did not converge,
 * or that the posterior excludes its pose. Empty if neither is so, if the final
 * transformation is the posterior mean, or if there is no posterior to rely on. */
std::string
icpNote(const Run& run);

/** \brief Where the scale of the standard deviations is from; empty for preset
 * calibrated, which estimates it. */
std::string
scaleNote(Preset preset);

/** \brief "not mixed: the chains ..."
 * \param[in] name short name of the Status */
std::string
statusText(std::string name, const std::string& message);

std::string
statusText(const Summary& summary);

/** \brief "Source: a.pcd, 300 points". */
std::string
cloudLine(const char* role, const io::CloudFile& cloud);

/** \brief The argument of `pcl_transform_point_cloud -matrix`: 16 numbers row by row.
 */
std::string
matrixText(const Eigen::Matrix4d& matrix);

/** \brief "wrong basin, misfit"; empty if no flag is raised. */
std::string
flagNames(const DataFlags& flags);

/** \brief What determines the pose along a direction: "data", "weak" or "prior". */
const char*
holderOf(Observability observability);

/** \brief Standard deviation of the angle along a direction [rad]; NaN for a
 * translation. */
double
angularDeviation(const DataDirection& direction);

/** \brief \p text with blanks behind it, \p width characters or more. */
std::string
leftAligned(std::string text, std::size_t width);

/** \brief A number in full if it is below 1e9.
 * \param[in] unknown stands for numbers that are not finite */
std::string
numberText(double value, int num_decimals, const std::string& unknown);

/** \brief A number, right aligned; "-" if it is not finite. */
std::string
cell(double value, int num_decimals, std::size_t width);

/** \brief Lines of at most 88 characters, those after the first indented. */
std::string
wrapped(const std::string& text);

} // namespace bayesian_icp::app
