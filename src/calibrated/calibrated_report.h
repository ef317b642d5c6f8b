/** \file
 * \brief Makes the report for users from the calibrated estimate.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"

#include <bayesian_icp/data_report.h>

namespace bayesian_icp {

/** \brief The report of \p estimate; directions are ordered by their posterior standard
 * deviation.
 * \param[in] estimate to report
 * \param[in] noise unit of its residual_scale [m] */
DataReport
dataReportOf(const CalibratedEstimate& estimate, double noise);

} // namespace bayesian_icp
