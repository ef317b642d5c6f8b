/** \file
 * \brief The settings that only preset `calibrated` has: names and descriptions.
 */
#pragma once

#include "register/field.h"

namespace bayesian_icp::app {

/** \brief Call visit(field, value) for the settings of preset `calibrated`. */
template <typename CalibratedT, typename Visitor>
void
visitCalibrated(CalibratedT& calibrated, Visitor& visit)
{
  visit({"calibrated",
         "max_source_points",
         "calibrated-points",
         "N",
         "Largest number of source points. Of a larger source, this many points are "
         "used that cover it evenly."},
        calibrated.max_source_points);
  visit({"calibrated",
         "num_mode_points",
         "mode-points",
         "N",
         "Number of these points that are used to follow the starts to their modes."},
        calibrated.num_mode_points);
}

} // namespace bayesian_icp::app
