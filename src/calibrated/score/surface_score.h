/** \file
 * \brief What every source point says about the pose: robust scores of its distance to
 * the target's surface.
 */
#pragma once

#include "calibrated/surface/surface_model.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Six numbers for each point, one point per column. */
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/** \brief Nearest patch of each source point at the last evaluation; speeds up the next
 * one and never changes it. One object per thread. */
using PatchHints = std::vector<std::uint32_t>;

/** \brief Scores of all points at one pose, in twists about a centre. */
struct SurfaceScores {
  /** Residual u = distance / sigma of each point; 0 where there is no patch. */
  Eigen::VectorXd residuals;
  /** Whether a point has a usable patch. */
  std::vector<char> has_patch;
  /** Whether it also has a (Tukey) weight above zero. */
  std::vector<char> active;
  /** psi(u) J^T n / sigma [1/m, 1/rad], zero if not active. */
  Matrix6Xd scores;
  /** sqrt(w) J^T n / sigma: its outer product is the Gauss-Newton information. */
  Matrix6Xd jacobians;
  /** Sum of the scores: gradient of the robust energy. */
  Vector6d total;
  /** Sum of the Gauss-Newton informations. */
  Matrix6d information;
  int num_active;
};

/** \brief Tukey's weight (1 - z^2)^2, zero beyond |z| = 1; z is the residual over
 * SurfaceScorer::tukey_constant times its scale. */
double
tukeyWeight(double z);

/** \brief Robust scale 1.4826 median |u| of the residuals of points with a patch, at
 * least 0.3. */
double
residualScale(const SurfaceScores& scores);

/** \brief min(|u|, 5) of each point; NaN of a point without a usable patch. */
Eigen::VectorXd
cappedResiduals(const SurfaceScores& scores);

/** \brief Mean of min(|u|, 5). A point without a usable patch counts 5. */
double
meanCappedResidual(const SurfaceScores& scores);

/** \brief Evaluates scores. Functions are const; threads may share an object. */
class SurfaceScorer {
public:
  /** Tukey's constant: 95 % efficiency on Gaussian residuals. */
  static constexpr double tukey_constant = 4.685;
  /** A point has no patch if it is further from the nearest one than this part of its
   * radius (see SurfaceOffset::in_plane). */
  static constexpr double max_in_plane = 0.6;

  /** \param[in] source_points 3 x n, finite, source frame [m]
   * \param[in] model must outlive this object */
  SurfaceScorer(const Eigen::Matrix3Xd& source_points, const SurfaceModel& model);

  /** \brief A scorer of the first points, of all if there are fewer. Its centroid is
   * that of all points, so that twists are the same. */
  SurfaceScorer
  ofFirst(Eigen::Index num_points) const;

  /** \brief Evaluate all points.
   * \param[in] T_target_source where
   * \param[in] tau scale of the residuals in Tukey's weight; infinite: least squares
   * \param[in] centre of the twists, target frame [m]
   * \param[in,out] hints empty, or of an earlier call on this object
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
   * \param[in] indices columns of the source, repeats allowed
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

  const Eigen::Matrix3Xd&
  sourcePoints() const
  {
    return source_points_;
  }

  const SurfaceModel&
  model() const
  {
    return model_;
  }

  /** \brief The source's centroid, source frame [m]. */
  const Eigen::Vector3d&
  centroid() const
  {
    return centroid_;
  }

private:
  Eigen::Matrix3Xd source_points_;
  Eigen::Vector3d centroid_;
  const SurfaceModel& model_;
};

} // namespace bayesian_icp
