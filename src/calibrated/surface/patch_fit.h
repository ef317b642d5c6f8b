/** \file
 * \brief One patch of surface from the points around it.
 */
#pragma once

#include "calibrated/surface/surface_model.h"
#include "search/point_neighbors.h"

#include <bayesian_icp/pose.h>

#include <utility>
#include <vector>

namespace bayesian_icp {

/** \brief One point per row: loops over points are vectorised. */
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/** \brief Buffers of one thread. */
struct PatchFitWorkspace {
  NeighborList nearest;
  std::vector<double> ordered;
  std::vector<std::pair<double, double>> places;
  PointRows ball, neighbors;
};

/** \brief Least-squares quadric of the neighbourhood of \p point, or its plane if no
 * quadric fits. The neighbourhood grows while it is not much wider than its noise, or
 * while it is as narrow as a scan line.
 *
 * \param[in] max_radius of a neighbourhood [m]; a wider one is not a patch
 * \param[in,out] workspace of earlier points of the same cloud, or new
 * \param[out] spacing distance to the nearest other point [m]
 * \return the patch; its sigma is that of this neighbourhood alone */
SurfacePatch
fitPatch(const PointNeighbors& cloud,
         const Eigen::Vector3f& point,
         double max_radius,
         const SurfaceModelOptions& options,
         PatchFitWorkspace& workspace,
         double& spacing);

} // namespace bayesian_icp
