/** \file
 * \brief Draws of the calibrated posterior: SGLD whose score is weighted such that the
 * spread is the calibrated covariance, and whose shape is that of the data.
 */
#pragma once

#include <bayesian_icp/calibration/calibrated_estimate.h>
#include <bayesian_icp/chains.h>

namespace bayesian_icp {

/** \brief Coordinates z = (a, b) of poses near a mode in which motions held by the
 * prior only come last: pose(z) = exp(V0 a) exp(VK b) mode, V0 the directions with keep
 * = 0, VK the others. */
class BAYESIAN_ICP_EXPORT ProductCoordinates {
public:
  explicit ProductCoordinates(const CalibratedEstimate& estimate);

  /** \brief Number of directions held by the prior only, the length of a. */
  int
  numPriorOnly() const
  {
    return num_prior_only_;
  }

  Eigen::Isometry3d
  pose(const Vector6d& z) const;

private:
  Eigen::Isometry3d mode_;
  Eigen::Vector3d centre_;
  Matrix6d directions_;
  int num_prior_only_;
};

/** \brief Draw by stochastic gradient Langevin dynamics over mini-batches of the source
 * (the guarded pre-weighted score of docs/calibration.md).
 *
 * Chains have their own random streams, so that draws are bit-identical for every
 * number of threads. options.num_burn_in 0 and thinning 1 are automatic. */
BAYESIAN_ICP_EXPORT ChainSet
sampleCalibrated(const SurfaceScorer& scorer,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
