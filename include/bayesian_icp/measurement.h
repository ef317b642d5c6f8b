/** \file
 * \brief What the clouds alone say of the pose: a posterior without its prior, for
 * filters and pose graphs that know by themselves what the prior knew.
 *
 * Mean and covariance of a posterior contain its prior. Who fuses them with the
 * odometry from which the prior was made counts the odometry twice, and becomes too
 * sure where the clouds say little. docs/pose_graph_and_filter.md says when to use
 * what.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/exports.h>
#include <bayesian_icp/prior.h>

namespace bayesian_icp {

/** \brief Ratio of posterior to prior standard deviation above which draws cannot tell
 * a direction from one that the clouds do not see: of min_ess draws whose variance is 1
 * in all six directions, the smallest is (1 - sqrt(6 / 400))^2 = 0.77, give or take
 * 0.03, and this is four times that below. */
constexpr double max_measured_share_of_prior = 0.8;

/** \brief Standard deviation given to directions that the clouds do not see, in units
 * of the prior's: their information is a ten-thousandth of the prior's. */
constexpr double unmeasured_deviation = 100.0;

/** \brief A posterior as a measurement that is independent of its prior. */
struct BAYESIAN_ICP_EXPORT PoseMeasurement {
  /** Mean and covariances of the clouds' likelihood, as a Gaussian. Where they say
   * nothing the mean is the posterior's and the standard deviation
   * unmeasured_deviation times the prior's, so that the covariance can be inverted. */
  PoseEstimate estimate;
  /** Number of directions in which they say nothing, 0 to 6. */
  int num_unmeasured = 0;
};

/** \brief Take the prior out of a posterior: information and mean (in information form)
 * of the posterior minus those of the prior, linearised at the posterior mean.
 *
 * Fused with the prior again it is the posterior. Right as far as the posterior is
 * nearly Gaussian.
 * \param[in] posterior mean and covariances
 * \param[in] prior with which \p posterior was sampled
 * \return NaN if \p posterior has no finite mean and covariance */
BAYESIAN_ICP_EXPORT PoseMeasurement
withoutPrior(const PoseEstimate& posterior, const Prior& prior);

/** \brief The prior as a Gaussian about its mean, with status Ok. */
BAYESIAN_ICP_EXPORT PoseEstimate
estimateOf(const Prior& prior);

} // namespace bayesian_icp
