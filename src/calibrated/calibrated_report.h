/** \file
 * \brief From the calibrated estimate to the report for users.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"

#include <bayesian_icp/data_report.h>

#include <cstddef>

namespace bayesian_icp {

/** \brief The report of \p estimate; directions are ordered by their posterior standard
 * deviation.
 * \param[in] estimate to report
 * \param[in] num_source_points source points that were used, positive
 * \param[in] target that the estimate is of */
DataReport
dataReportOf(const CalibratedEstimate& estimate,
             std::size_t num_source_points,
             const SurfaceModel& target);

} // namespace bayesian_icp
