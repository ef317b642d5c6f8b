/** \file
 * \brief Energy and gradient for given correspondences, as pure functions of the pose.
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/pose.h>

namespace bayesian_icp {

/** \brief Scale of the likelihood. The energy is N / sigma^2 times the mean of |p -
 * q|^2 / 2 over the source. */
struct LikelihoodOptions {
  /** N of eq. (5), which is not the size of the cloud. The paper fixes it "so that a
   * single step size can be used". Positive, dimensionless. */
  double effective_points = 6000.0;
  /** sigma, standard deviation of a point-to-point distance [m]. The paper's scale is
   * implicitly 1 m. Positive. */
  double measurement_sigma = 1.0;

  /** \brief N / sigma^2 [1/m^2]. */
  double
  weight() const
  {
    return effective_points / (measurement_sigma * measurement_sigma);
  }
};

/** \brief Move source points into the target frame: column i is R s_i + u [m]. */
BAYESIAN_ICP_EXPORT void
movePoints(const Vector6d& pose,
           const Eigen::Matrix3Xd& source_points,
           Eigen::Matrix3Xd& moved_points);

/** \brief Mean energy of a mini-batch, (1/m) sum |R s_i + u - q_i|^2 / 2 [m^2]: half of
 * eq. (1). m is the number of columns. Points without a correspondence count as zero.
 */
BAYESIAN_ICP_EXPORT double
meanEnergy(const Vector6d& pose,
           const Eigen::Matrix3Xd& source_points,
           const Correspondences& correspondences);

/** \brief Mean gradient of a mini-batch, eqs. (2) and (3), with respect to (x, y, z,
 * roll, pitch, yaw) [m, m^2/rad]. It is the gradient of meanEnergy at fixed
 * correspondences.
 * \param[in] pose at which the gradient is taken [m, rad]
 * \param[in] source_points 3 x m, source frame [m]
 * \param[in] moved_points 3 x m, the same points in the target frame [m]
 * \param[in] correspondences of the moved points */
BAYESIAN_ICP_EXPORT Vector6d
meanGradient(const Vector6d& pose,
             const Eigen::Matrix3Xd& source_points,
             const Eigen::Matrix3Xd& moved_points,
             const Correspondences& correspondences);

} // namespace bayesian_icp
