/** \file
 * \brief The settings that only preset `calibrated` has: names and descriptions.
 */
#pragma once

#include "register/field.h"

namespace bayesian_icp::app {

/** \brief Call visit(field, value) for what only preset `calibrated` has. */
template <typename CalibratedT, typename Visitor>
void
visitCalibrated(CalibratedT& calibrated, Visitor& visit)
{
  visit({"calibrated",
         "max_source_points",
         "calibrated-points",
         "N",
         "largest number of source points; of a larger source so many are chosen at "
         "random"},
        calibrated.max_source_points);
  visit({"calibrated",
         "num_mode_points",
         "mode-points",
         "N",
         "of these, points on which the starts are followed to their modes"},
        calibrated.num_mode_points);
}

} // namespace bayesian_icp::app
