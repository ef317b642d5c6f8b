/** \file
 * \brief What preset `calibrated` makes of a target: its surface, or why it has none.
 */
#pragma once

#include "calibrated/surface/surface_model.h"

#include <bayesian_icp/summary.h>

#include <string>

namespace bayesian_icp {

/** \brief A target to whose surface distances are measured. */
struct PreparedSurface {
  SurfaceModel model;
  /** Why distances to the surface mean nothing; empty if they do. */
  std::string complaint;
  /** The status that goes with the complaint. */
  Status status = Status::NotRun;
};

/** \brief The surface of a target. Each of its finite points counts once: merged clouds
 * often have points twice, whose spacing and noise of zero say nothing about a surface.
 * \param[in] points 3 x n, target frame [m]
 * \param[in] num_threads 0: as OpenMP would */
PreparedSurface
prepareSurface(const Eigen::Matrix3Xd& points, int num_threads);

} // namespace bayesian_icp
