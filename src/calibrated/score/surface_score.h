/** \file
 * \brief Scores of all points of the two clouds: gradients of the robust energy of
 * their distances to the other cloud's surface.
 */
#pragma once

#include "calibrated/surface/surface_model.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace bayesian_icp {

/** \brief Six numbers per point, one point per column. */
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/** \brief Nearest patch of each point at the last evaluation. Hints speed up the next
 * evaluation and never change its result. One object per thread. */
using PatchHints = std::vector<std::uint32_t>;

/** \brief Scores of all points at one pose, in twists about a centre: first the
 * source's points, then the target's. */
struct SurfaceScores {
  /** Residual u = distance / sigma of each point; 0 where there is no patch. */
  Eigen::VectorXd residuals;
  /** Whether a point has a usable patch. */
  std::vector<char> has_patch;
  /** How far a point without a patch is off the continuation of the nearest patch
   * beyond its border: Tukey's energy as a fraction of its maximum. 1 where the nearest
   * patch is not usable, and for all points if less than a tenth of them have a patch.
   */
  Eigen::VectorXd off_continuation;
  /** Whether a point has a patch and a Tukey weight above zero. */
  std::vector<char> active;
  /** psi(u) J^T n / sigma [1/m, 1/rad], zero if not active. */
  Matrix6Xd scores;
  /** sqrt(w) J^T n / sigma. Its outer product is the Gauss-Newton information of the
   * point. */
  Matrix6Xd jacobians;
  /** Sum of the scores: gradient of the robust energy. */
  Vector6d total;
  /** Sum of the Gauss-Newton informations. */
  Matrix6d information;
  int num_active = 0;
  /** Number of active source points, and of all source points. */
  int num_active_of_source = 0;
  Eigen::Index num_source_points = 0;
};

/** \brief Shares of the active points of each cloud, in [0, 1]; NaN if no points of it
 * are compared. */
struct ActiveShares {
  double source, target;
};

ActiveShares
activeSharesOf(const SurfaceScores& scores);

/** \brief Tukey's weight (1 - z^2)^2, zero beyond |z| = 1. z is the residual divided by
 * SurfaceScorer::tukey_constant and the scale. */
double
tukeyWeight(double z);

/** \brief Tukey's energy 1 - (1 - z^2)^3 as a fraction of its maximum, which it reaches
 * at |z| = 1. */
double
tukeyEnergy(double z);

/** \brief Robust scale 1.4826 median |u| of the residuals of points with a patch, at
 * least 0.3. */
double
residualScale(const SurfaceScores& scores);

/** \brief min(|u|, 5) of each source point, or of each target point if there are no
 * others; NaN if it has no usable patch. */
Eigen::VectorXd
cappedResiduals(const SurfaceScores& scores);

/** \brief Statistics of the points that have a patch at a pose. */
struct Contacts {
  /** Their share of all points. */
  double share = 0.0;
  /** Mean of their cappedResiduals(); NaN if there are none. */
  double misfit = 0.0;
};

Contacts
contactsOf(const Eigen::VectorXd& capped_residuals);

/** \brief Mean of min(|u|, 5) over the points of cappedResiduals(). A point without a
 * usable patch counts 5. */
double
meanCappedResidual(const SurfaceScores& scores);

/** \brief Like meanCappedResidual(), but a point on the continuation of the other
 * cloud's surface may count less than 5, down to the mean of the points with a patch.
 */
double
costOf(const SurfaceScores& scores);

/** \brief Evaluates scores of source points against the target's surface, and of target
 * points against the source's, if target points were added. Threads may share an
 * object, whose functions for evaluation are const. */
class SurfaceScorer {
public:
  /** Tukey's constant: 95 % efficiency on Gaussian residuals. */
  static constexpr double tukey_constant = 4.685;
  /** A point has no patch if its in-plane distance from the nearest patch
   * (SurfaceOffset::in_plane) is above this fraction of the patch's radius. */
  static constexpr double max_in_plane = 0.6;

  /** \param[in] source_points 3 x n, finite, source frame [m]
   * \param[in] model must outlive this object
   * \param[in] num_threads of evaluate(); 0: as OpenMP would */
  SurfaceScorer(const Eigen::Matrix3Xd& source_points,
                const SurfaceModel& model,
                int num_threads = 1);

  /** \brief Add \p target_points (3 x m, finite, target frame [m]) to be compared with
   * the surface of the source.
   * \param[in] source_model must outlive this object */
  void
  addTargetPoints(const Eigen::Matrix3Xd& target_points,
                  const SurfaceModel& source_model);

  /** \brief Take the noise of the source's points from the surface of the source. A
   * patch of the cleaner cloud, for example of a CAD model, is not known better than
   * the points that meet it: its sigma is at least the median sigma of their cloud,
   * less 0.7 times that of its own. This is 0.3 times a noise that both have, which no
   * patch is below, and the noise of one cloud if the other is exact. The sigma of wide
   * patches is rather the roughness of the surface than noise, so it is reduced to the
   * median radius of the patches that it is compared with. */
  void
  setSourceNoise(const SurfaceModel& source_model);

  /** \brief State that the source lies in a plane with this unit normal (source frame)
   * and the target does not. The rays of a 2-D scanner do not meet a surface that is
   * parallel to their plane, so a source point has no patch there. Without this, a scan
   * would fit best where all of it lies on the floor. */
  void
  setRayPlane(const Eigen::Vector3d& normal)
  {
    ray_plane_ = normal;
  }

  /** \brief A scorer of the first \p num_points source points, or of all if there are
   * fewer. It keeps the centroid of all points, so that twists are the same. Of a
   * scorer without source points, it has the first target points. */
  SurfaceScorer
  ofFirst(Eigen::Index num_points) const;

  /** \brief A scorer of the target points alone. Twists are the same. */
  SurfaceScorer
  ofTarget() const;

  /** \brief A scorer of the first points of both clouds, of each the same share. */
  SurfaceScorer
  ofFirstOfBoth(Eigen::Index num_points) const;

  /** \brief Nearest-neighbour queries so far, of this scorer and of all that were made
   * from one. Those of batchScore() do not count. */
  long
  numQueries() const
  {
    return *num_queries_;
  }

  /** \brief Count queries of the clouds that were made without evaluate(). */
  void
  countQueries(Eigen::Index num_queries) const
  {
    *num_queries_ += num_queries;
  }

  /** \brief Evaluate all points, with the same bits for every number of threads.
   * \param[in] T_target_source where
   * \param[in] tau scale of the residuals in Tukey's weight; infinite: least squares;
   *            0: no point is active
   * \param[in] centre of the twists, target frame [m]
   * \param[in,out] hints empty, or from an earlier call on this object
   * \param[out] scores of all points */
  void
  evaluate(const Eigen::Isometry3d& T_target_source,
           const Eigen::Vector3d& centre,
           double tau,
           PatchHints& hints,
           SurfaceScores& scores) const;

  /** \brief Sum of the scores of some points.
   * \param[in] T_target_source where
   * \param[in] centre of the twists, target frame [m]
   * \param[in] tau as in evaluate()
   * \param[in] indices of points, in the order of SurfaceScores, repeats allowed
   * \param[in,out] hints as in evaluate()
   * \param[out] total sum of their scores
   * \return how many of them have a usable patch, whatever their weight */
  int
  batchScore(const Eigen::Isometry3d& T_target_source,
             const Eigen::Vector3d& centre,
             double tau,
             const std::vector<std::size_t>& indices,
             PatchHints& hints,
             Vector6d& total) const;

  /** \brief Number of points of both clouds. */
  Eigen::Index
  numPoints() const
  {
    return source_points_.cols() + target_points_.cols();
  }

  /** \brief All points in the source's frame [m]. */
  Eigen::Matrix3Xd
  pointsAt(const Eigen::Isometry3d& T_target_source) const;

  /** \brief The source's points, or the target's if there are no others, in the
   * source's frame [m]. */
  Eigen::Matrix3Xd
  leadingPoints(const Eigen::Isometry3d& T_target_source) const
  {
    return source_points_.cols() > 0 ? source_points_ : pointsAt(T_target_source);
  }

  /** \brief The surface that a point is compared with.
   * \param[in] point in the order of SurfaceScores */
  const SurfaceModel&
  modelOf(Eigen::Index point) const
  {
    return point < source_points_.cols() ? model_ : *source_model_;
  }

  /** \brief Where a point is in the frame of modelOf() at a pose [m]. */
  Eigen::Vector3d
  placeOf(Eigen::Index point, const Eigen::Isometry3d& T_target_source) const
  {
    const Eigen::Index num_source = source_points_.cols();
    return point < num_source
               ? T_target_source * source_points_.col(point) - model_.origin()
               : T_target_source.inverse() * target_points_.col(point - num_source) -
                     source_model_->origin();
  }

  const Eigen::Matrix3Xd&
  sourcePoints() const
  {
    return source_points_;
  }

  /** \brief The target's points that were added, target frame [m]. */
  const Eigen::Matrix3Xd&
  targetPoints() const
  {
    return target_points_;
  }

  /** \brief Unit of lengths: the target's median noise, or that of the source where the
   * target is far cleaner [m]. */
  double
  noise() const
  {
    return std::max(model_.medianSigma(), min_sigma_);
  }

  /** \brief The source's centroid, source frame [m]. */
  const Eigen::Vector3d&
  centroid() const
  {
    return centroid_;
  }

private:
  class Placement;

  /** A scorer that has other points, and all else in common. */
  SurfaceScorer(const SurfaceScorer& all,
                const Eigen::Matrix3Xd& source_points,
                const Eigen::Matrix3Xd& target_points);

  Eigen::Matrix3Xd source_points_;
  Eigen::Vector3d centroid_;
  const SurfaceModel& model_;
  int num_threads_;
  std::shared_ptr<std::atomic<long>> num_queries_ =
      std::make_shared<std::atomic<long>>(0);
  Eigen::Matrix3Xd target_points_;
  const SurfaceModel* source_model_ = nullptr;
  /** Smallest sigma of the target's and of the source's patches [m]. */
  double min_sigma_ = 0.0, min_source_sigma_ = 0.0;
  /** See setRayPlane(); zero if the source is not flat. */
  Eigen::Vector3d ray_plane_ = Eigen::Vector3d::Zero();
};

} // namespace bayesian_icp
