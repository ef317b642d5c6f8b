/** \file
 * \brief One patch of surface from the points around it.
 */
#pragma once

#include <bayesian_icp/calibration/surface_model.h>
#include <bayesian_icp/pose.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace bayesian_icp {

/** \brief Nearest points of a cloud that does not change, k at a time. */
class PointNeighbors {
public:
  /** \param[in] points 3 x n, finite; must outlive this object */
  explicit PointNeighbors(const Eigen::Matrix3Xf& points);
  ~PointNeighbors();
  PointNeighbors(const PointNeighbors&) = delete;
  PointNeighbors&
  operator=(const PointNeighbors&) = delete;

  /** \brief The \p count nearest points, nearest first; fewer if there are fewer. */
  void
  find(const Eigen::Vector3f& query,
       std::size_t count,
       std::vector<std::uint32_t>& indices,
       std::vector<float>& squared_distances) const;

  const Eigen::Matrix3Xf&
  points() const
  {
    return points_;
  }

private:
  struct Index;

  const Eigen::Matrix3Xf& points_;
  std::unique_ptr<const Index> index_;
};

/** \brief One point a row: loops over points are vectorised. */
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/** \brief Buffers of one thread. */
struct PatchFitWorkspace {
  std::vector<std::uint32_t> indices;
  std::vector<float> squared_distances;
  std::vector<double> ordered;
  PointRows neighbors;
};

/** \brief Least-squares quadric of the neighbourhood of \p point. The neighbourhood
 * grows while it is no wider than its noise or as narrow as a scan line.
 * \param[out] workspace indices: the points around it, nearest first
 * \param[out] spacing distance to the nearest other point [m]
 * \return the patch; its sigma is that of this neighbourhood alone */
SurfacePatch
fitPatch(const PointNeighbors& cloud,
         const Eigen::Vector3f& point,
         const SurfaceModelOptions& options,
         PatchFitWorkspace& workspace,
         double& spacing);

} // namespace bayesian_icp
