/** \file
 * \brief Fit of one patch of surface to the points around it.
 */
#pragma once

#include "calibrated/surface/layers.h"
#include "calibrated/surface/surface_model.h"
#include "search/point_neighbors.h"

#include <bayesian_icp/pose.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace bayesian_icp {

/** \brief Buffers of one thread. */
struct PatchFitWorkspace {
  NeighborList nearest;
  std::vector<double> ordered;
  std::vector<std::pair<double, double>> places, ordered_places;
  std::vector<std::uint32_t> buckets;
  PointRows ball, neighbors;
};

/** \brief Fit a quadric to the neighbourhood of \p point by least squares, or a plane
 * if no quadric fits. The neighbourhood grows while it is not much wider than its
 * noise, or while it is as narrow as a scan line.
 *
 * \param[in] plane_normal null, or the unit normal of the plane in which the cloud
 *            lies; the patch is then a piece of curve: a parabola, or a line
 * \param[in] max_radius largest radius of a neighbourhood [m]; a wider one has no patch
 * \param[in,out] workspace from earlier points of the same cloud, or new
 * \param[out] spacing distance to the nearest other point [m]
 * \return the patch, whose sigma comes from this neighbourhood alone */
SurfacePatch
fitPatch(const PointNeighbors& cloud,
         const Eigen::Vector3f& point,
         const Eigen::Vector3d* plane_normal,
         double max_radius,
         const SurfaceModelOptions& options,
         PatchFitWorkspace& workspace,
         double& spacing);

/** \brief Whether a patch is a quadric that misses its points by less than a thousandth
 * of its radius, as in a cloud without noise. */
bool
isExactQuadric(const SurfacePatch& patch);

} // namespace bayesian_icp
