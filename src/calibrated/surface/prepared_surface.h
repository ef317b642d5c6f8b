/** \file
 * \brief The surface of a target for preset `calibrated`, or the reason why it has
 * none.
 */
#pragma once

#include "calibrated/surface/surface_model.h"

#include <bayesian_icp/summary.h>

#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief A target and its surface. */
struct PreparedSurface {
  SurfaceModel model;
  /** Why distances to the surface are meaningless; empty if they are valid. */
  std::string complaint;
  /** Status that belongs to the complaint. */
  Status status = Status::NotRun;
  /** Columns of the points that are used: finite and not stray. */
  std::vector<Eigen::Index> columns;
};

/** \brief Make the surface of a target. Each of its finite points counts once: merged
 * clouds often repeat points, and the zero spacing and noise of repeated points would
 * be wrong.
 * \param[in] points 3 x n, target frame [m]
 * \param[in] num_threads 0: as OpenMP would
 * \param[in] num_doublings of the number of patches; see numDoublings() */
PreparedSurface
prepareSurface(const Eigen::Matrix3Xd& points, int num_threads, int num_doublings = 0);

} // namespace bayesian_icp
