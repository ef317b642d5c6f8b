/** \file
 * \brief The posterior density of the pose for the sampler of Algorithm 1:
 * correspondence search, likelihood gradient of a mini-batch, prior gradient.
 */
#pragma once

#include "paper/matched_batch.h"
#include "paper/sgld.h"

#include <bayesian_icp/prior.h>

namespace bayesian_icp {

/** \brief Stochastic energy gradients for one chain. It owns the chain's mini-batches
 * and buffers. It shares the source, the search and the prior, and only reads them. */
class PosteriorGradient {
public:
  /** \param[in] source_points 3 x n, source frame [m]; must outlive this object, like
   *            \p search and \p prior
   * \param[in] search finds correspondences in the target
   * \param[in] prior of the pose
   * \param[in] weight N / sigma^2 [1/m^2]
   * \param[in] mini_batches of this chain */
  PosteriorGradient(const Eigen::Matrix3Xd& source_points,
                    const CorrespondenceSearch& search,
                    const Prior& prior,
                    double weight,
                    const MiniBatches& mini_batches);

  /** \brief Gradient of -log posterior at \p pose, estimated from the next mini-batch:
   * weight times the mean gradient, eqs. (2) and (3), plus the prior's, eqs. (6) and
   * (7). */
  EnergyGradient
  operator()(const Vector6d& pose, Random& random);

private:
  const Prior& prior_;
  double weight_;
  MatchedBatch batch_;
};

} // namespace bayesian_icp
