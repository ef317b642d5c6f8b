/** \file
 * \brief What the clouds say about the pose, in print.
 */
#pragma once

#include <bayesian_icp/data_report.h>

#include <string>

namespace bayesian_icp::app {

/** \brief A table of directions, the noise that was found, support and flags; empty if
 * there is no report. */
std::string
dataText(const DataReport& report);

/** \brief A flag and its name in files. */
struct DataFlag {
  const char* key;
  bool DataFlags::*is_raised;
};

constexpr DataFlag data_flags[] = {{"wrong_basin", &DataFlags::wrong_basin},
                                   {"low_support", &DataFlags::low_support},
                                   {"few_patches", &DataFlags::few_patches},
                                   {"misfit", &DataFlags::misfit},
                                   {"no_information", &DataFlags::no_information},
                                   {"prior_conflict", &DataFlags::prior_conflict}};

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

} // namespace bayesian_icp::app
