/** \file
 * \brief Gaussian prior on the translation, von Mises prior on the angles.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <limits>

namespace bayesian_icp {

/** \brief The point whose translation the prior describes. */
enum class PriorFrame {
  /** The origin of the source frame, as in the paper. */
  Origin,
  /** The centroid of the source points. This suits objects away from the sensor: a
   * rotation about the origin moves such an object far. */
  SourceCentroid,
  /** Origin. For preset `calibrated`, SourceCentroid if the cloud is far from the
   * origin for its size: see priorFrameOf(). */
  Automatic
};

/** \brief Short name: "origin", "source-centroid" or "automatic". */
BAYESIAN_ICP_EXPORT const char*
toString(PriorFrame frame);

/** \brief What is known about the pose before the clouds are seen. */
struct PriorOptions {
  /** Mean source-to-target pose (x, y, z, roll, pitch, yaw) [m, rad]. Six NaN (the
   * default) mean the initial guess. */
  Vector6d mean = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  /** Variance of x, y, z [m^2] and 1/kappa of roll, pitch, yaw [rad^2], eqs. (6) and
   * (7). At least 1e-24; infinity means no prior on that coordinate, which preset
   * `calibrated` does not accept. Nor does it accept variances so far apart that double
   * precision loses the large ones about the source's centroid: tiny ones of x, y and z
   * about an origin aside, with large ones of the angles. */
  Vector6d variance = Vector6d::Constant(0.125);
  /** The point whose translation x, y, z describe. */
  PriorFrame frame = PriorFrame::Automatic;
};

/** \brief Energy -log p(theta) of the prior, up to a constant, and its gradient.
 *
 * With c the reference point (0, or the source centroid) and d = (R c + u) -
 * (R_mean c + u_mean), the energy is sum d_k^2 / (2 v_k) over x, y, z plus
 * sum kappa_k (1 - cos(theta_k - mean_k)) over the angles, kappa_k = 1 / v_k.
 */
class BAYESIAN_ICP_EXPORT Prior {
public:
  /** \param[in] mean pose [m, rad]
   * \param[in] variance six positive numbers [m^2, rad^2]
   * \param[in] reference_point c, source frame [m] */
  Prior(const Vector6d& mean,
        const Vector6d& variance,
        const Eigen::Vector3d& reference_point = Eigen::Vector3d::Zero());

  /** \brief -log p(theta) up to a constant. */
  double
  energy(const Vector6d& pose) const;

  /** \brief Gradient of energy() with respect to the pose: eqs. (6) and (7) for c = 0.
   */
  Vector6d
  energyGradient(const Vector6d& pose) const;

  /** \brief d of the class description, and theta_k - mean_k without wrapping [m, rad].
   */
  Vector6d
  deviation(const Vector6d& pose) const;

  /** \brief The mean pose [m, rad]. */
  const Vector6d&
  mean() const
  {
    return mean_;
  }

  /** \brief c of the class description, source frame [m]. */
  const Eigen::Vector3d&
  referencePoint() const
  {
    return reference_point_;
  }

  /** \brief The six variances [m^2, rad^2]. */
  const Vector6d&
  variance() const
  {
    return variance_;
  }

private:
  Vector6d mean_;
  Vector6d variance_;
  Eigen::Vector3d reference_point_;
  Eigen::Vector3d mean_reference_point_;
};

} // namespace bayesian_icp
