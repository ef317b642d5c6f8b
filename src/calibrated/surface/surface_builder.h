/** \file
 * \brief Internal: the stages of building a SurfaceModel.
 */
#pragma once

#include "calibrated/surface/surface_model.h"
#include "search/point_neighbors.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace bayesian_icp {

/** \brief Fits a patch to every chosen point of a target, and corrects patches with the
 * help of their neighbours. Call each stage once, in the order below. All stages are
 * parallel and give the same bits for every number of threads. */
class SurfaceBuilder {
public:
  /** \param[in] points 3 x n, finite, relative to the model's origin [m]; must outlive
   *            this object
   * \param[in] plane_normal of fitPatch()
   * \param[in] options of the patches
   * \param[in] num_threads 0: as OpenMP would */
  SurfaceBuilder(const Eigen::Matrix3Xf& points,
                 const std::optional<Eigen::Vector3d>& plane_normal,
                 const SurfaceModelOptions& options,
                 int num_threads);

  void
  fitPatches();

  /** \brief Pool the noise of every quadric over the quadrics around it. */
  void
  poolNoise();

  /** \brief Let each point without a quadric take over the quadric of a neighbour on
   * which it lies. */
  void
  takeOver();

  /** \brief The points of the patches, projected to their surfaces. */
  Eigen::Matrix3Xf
  projectedPoints() const;

  std::vector<SurfacePatch>
  takePatches();

  /** \brief Median of the pooled noise [m]. */
  double
  medianSigma() const
  {
    return median_sigma_;
  }

  /** \brief Median distance of a point to its nearest neighbour [m]. */
  double
  spacing() const;

private:
  /** Number of patches over which noise is pooled, and among which a point without a
   * quadric looks for one to take over. */
  static constexpr std::size_t num_nearest = 12;

  /** The nearest patches of a patch; the first is the patch itself. */
  struct NearestPatches {
    std::array<std::uint32_t, num_nearest> patches;
    std::uint32_t count = 0;
  };

  void
  adaptToExactCloud(const PointNeighbors& cloud, double max_radius);

  void
  noteNeighbors(const std::vector<std::uint32_t>& points,
                NearestPatches& nearest) const;

  void
  completeNeighbors();

  double
  pooledNoise(std::size_t patch) const;

  std::uint32_t
  donorOf(std::size_t patch) const;

  const std::optional<Eigen::Vector3d> plane_normal_;
  SurfaceModelOptions options_;
  int num_threads_;
  const Eigen::Matrix3Xf& points_;
  /** The point of each patch. */
  std::vector<Eigen::Index> columns_;
  /** The patch of each point, or KdTree::none. */
  std::vector<std::uint32_t> patch_of_;
  std::vector<SurfacePatch> patches_;
  std::vector<NearestPatches> neighbors_;
  std::vector<double> spacings_;
  double median_sigma_ = 0.0;
  bool is_exact_ = false;
};

} // namespace bayesian_icp
