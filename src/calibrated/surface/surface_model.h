/** \file
 * \brief A cloud as a surface: patches that cover it evenly, each with its noise.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace bayesian_icp {

/** \brief Shape of the surface around a point. */
enum class PatchKind {
  /** No surface: too few points, a line, or a tangle. */
  None,
  /** A plane and its roughness: no quadric fits, or the point is at an edge. */
  Plane,
  /** A quadric to within the noise. */
  Quadric
};

/** \brief A piece of surface z = a0 + a1 x + a2 y + a3 x^2 + a4 x y + a5 y^2 in its own
 * frame; a3 to a5 of a plane are zero. */
struct SurfacePatch {
  /** Origin of the frame [m]. */
  Eigen::Vector3d origin;
  /** Columns: the frame's x, y and z; z is across the surface. If the cloud lies in a
   * plane, the surface stands on it: y is zero, and no position depends on it. */
  Eigen::Matrix3d axes;
  /** a0 ... a5 [m, 1, 1, 1/m, 1/m, 1/m]. */
  std::array<double, 6> quadric;
  /** The cloud point that the patch represents, after spreadLevels() [m]. It is the
   * origin, unless the quadric was taken over from a neighbour. */
  Eigen::Vector3d centre;
  /** In-plane (x, y) radius of the neighbourhood that was fitted [m]. */
  double radius;
  /** Standard deviation of the points across the surface [m]. For a quadric it is their
   * noise, pooled over neighbouring quadrics. For a plane it is its own roughness (four
   * times that in an exact cloud) and, where its points follow a curve, the possible
   * error of its slope. */
  double sigma;
  PatchKind kind;
  /** Whether the points of a plane follow one curve, like those of a scan line. They
   * hardly determine the slope across the curve. */
  bool follows_curve = false;
  /** Whether the points show which way the surface faces: they cover a piece that is
   * not long and narrow, evenly and not along separate scan lines, and that is clearly
   * wider than it is thick. */
  bool has_clear_normal = false;

  /** \brief Whether distances to the patch are meaningful. */
  bool
  isUsable() const
  {
    return kind != PatchKind::None;
  }
};

/** \brief Position of a point with respect to a patch. */
struct SurfaceOffset {
  /** Signed distance across the surface, to first order in its slope [m]. */
  double distance;
  /** In-plane distance from the patch's origin or from its centre, whichever is larger
   * [m]. The quadric is known around its origin, and the cloud has points around its
   * centre. */
  double in_plane;
  /** Unit normal of the surface under the point. */
  Eigen::Vector3d normal;
};

/** \brief Offset of \p point from \p patch, both in the frame of the model [m]. */
inline SurfaceOffset
offsetFrom(const SurfacePatch& patch, const Eigen::Vector3d& point)
{
  const auto& a = patch.quadric;
  const Eigen::Vector3d local = patch.axes.transpose() * (point - patch.origin);
  const double x = local.x(), y = local.y();
  const double height =
      a[0] + a[1] * x + a[2] * y + a[3] * x * x + a[4] * x * y + a[5] * y * y;
  const double slope_x = a[1] + 2.0 * a[3] * x + a[4] * y;
  const double slope_y = a[2] + a[4] * x + 2.0 * a[5] * y;
  const double length = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
  SurfaceOffset offset;
  offset.distance = (local.z() - height) / length;
  offset.normal = patch.axes * Eigen::Vector3d(-slope_x, -slope_y, 1.0) / length;
  offset.in_plane = local.head<2>().norm();
  if (patch.centre != patch.origin) {
    const Eigen::Vector3d from_centre = patch.axes.transpose() * (point - patch.centre);
    offset.in_plane = std::max(offset.in_plane, from_centre.head<2>().norm());
  }
  return offset;
}

/** \brief Options for fitting patches. docs/calibration.md explains the defaults. */
struct SurfaceModelOptions {
  /** Number of points of a neighbourhood. It is doubled where the neighbourhood is
   * hardly wider than its noise, or is a scan line. */
  int num_neighbors = 30;
  /** The same in an exact cloud, like that of a CAD model: there is no noise to
   * average, and small neighbourhoods keep off edges and the other side of walls. */
  int num_exact_neighbors = 12;
  /** Smallest ratio of a quadric's radius to its noise. */
  double min_radius_to_noise = 3.75;
  /** Largest F statistic of a quartic against the quadric. It is tested where the
   * quadric misses its points by more than a thousandth of the radius. */
  double max_misfit = 2.2;
  /** Largest distance of the neighbours' centroid from the point, in radii. A point
   * with a larger one is at an edge and has no quadric. */
  double max_centroid_offset = 0.28;
  /** A point without a quadric takes over that of a neighbour within this in-plane
   * distance, in radii of the neighbour; 0 for never. */
  double takeover_radius = 0.5;
  /** Largest number of patches. In a larger target, this many points, which cover the
   * target evenly, get a patch. Neighbourhoods come from four times as many points, so
   * that patches overlap in the same way at any density of the target. */
  int max_patches = 20000;

  /** \brief Largest number of points in neighbourhoods. */
  Eigen::Index
  maxPoints() const
  {
    return 4 * static_cast<Eigen::Index>(max_patches);
  }
};

/** \brief Centroid of \p columns of \p points, of which there is at least one [m]. */
Eigen::Vector3d
centroidOf(const Eigen::Matrix3Xd& points, const std::vector<Eigen::Index>& columns);

/** \brief \p columns of \p points, relative to \p origin [m], as far as single
 * precision reaches. */
Eigen::Matrix3Xf
relativeTo(const Eigen::Vector3d& origin,
           const Eigen::Matrix3Xd& points,
           const std::vector<Eigen::Index>& columns);

/** \brief Patches that cover a cloud evenly, and a tree to find them.
 *
 * Internal coordinates are relative to origin(), so that scans far from the origin of
 * their frame (UTM) lose no precision. Building is parallel and gives the same bits for
 * every number of threads. */
class SurfaceModel {
public:
  /** \param[in] target_points 3 x n [m]; points that are not finite or that repeat
   * another point are left out
   * \param[in] options of the patches
   * \param[in] num_threads 0: as OpenMP would */
  explicit SurfaceModel(const Eigen::Matrix3Xd& target_points,
                        const SurfaceModelOptions& options = SurfaceModelOptions(),
                        int num_threads = 0);

  /** \brief The surface of some \p columns of the points, all of them finite. */
  SurfaceModel(const Eigen::Matrix3Xd& target_points,
               const std::vector<Eigen::Index>& columns,
               const SurfaceModelOptions& options,
               int num_threads);

  /** \brief Origin of the model's frame, in the target frame [m]. */
  const Eigen::Vector3d&
  origin() const
  {
    return origin_;
  }

  const std::vector<SurfacePatch>&
  patches() const
  {
    return patches_;
  }

  /** \brief Tree of the points of patches(), projected to the patches, in the same
   * order and in the model's frame. */
  const KdTree&
  tree() const
  {
    return tree_;
  }

  /** \brief Median noise of the quadrics, or of all patches if fewer than a twentieth
   * are quadrics [m]; 0 without points. */
  double
  medianSigma() const
  {
    return median_sigma_;
  }

  /** \brief Median radius of the usable patches [m]; 0 if there are none. */
  double
  medianRadius() const
  {
    return median_radius_;
  }

  /** \brief Median distance of a patch's point to its nearest neighbour, among the
   * points that neighbourhoods are taken from [m]. */
  double
  spacing() const
  {
    return spacing_;
  }

  /** \brief Share of patches that are usable, in [0, 1]. */
  double
  usableFraction() const
  {
    return usable_fraction_;
  }

  /** \brief Unit normal of the plane in which all points lie on curves, like those of a
   * 2-D laser scanner; empty if they do not. */
  const std::optional<Eigen::Vector3d>&
  planeNormal() const
  {
    return plane_normal_;
  }

private:
  void
  build(const Eigen::Matrix3Xf& points,
        const SurfaceModelOptions& options,
        int num_threads,
        bool may_be_exact = true);

  Eigen::Vector3d origin_;
  std::optional<Eigen::Vector3d> plane_normal_;
  std::vector<SurfacePatch> patches_;
  KdTree tree_;
  double median_sigma_ = 0.0;
  double median_radius_ = 0.0;
  double spacing_ = 0.0;
  double usable_fraction_ = 0.0;
};

} // namespace bayesian_icp
