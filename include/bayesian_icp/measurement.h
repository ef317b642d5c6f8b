/** \file
 * \brief The information of the clouds alone: a posterior without its prior. Use it in
 * filters and pose graphs that already contain the information of the prior.
 *
 * Mean and covariance of a posterior contain its prior. If the prior was made from
 * odometry, and the posterior is fused with that odometry again, the odometry counts
 * twice. The result is then too certain along motions that the clouds hardly determine.
 * docs/pose_graph_and_filter.md describes when to use which.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/exports.h>
#include <bayesian_icp/prior.h>

namespace bayesian_icp {

/** \brief Ratio of posterior to prior standard deviation above which a direction counts
 * as unmeasured, because draws cannot distinguish it from one that the clouds do not
 * determine. For min_ess draws whose variance is 1 in all six directions, the smallest
 * variance is (1 - sqrt(6 / 400))^2 = 0.77 +- 0.03. The square of this constant is four
 * times that uncertainty below it. */
constexpr double max_measured_share_of_prior = 0.8;

/** \brief Standard deviation of unmeasured directions, in units of the prior's. Their
 * information is then a hundredth of the prior's. More would do harm: draws correlate
 * measured motions with unmeasured ones by chance, some 1 / sqrt(ESS), and the
 * variance of a measured motion grows by the square of this constant times that of the
 * correlation. */
constexpr double unmeasured_deviation = 10.0;

/** \brief A posterior as a measurement that is independent of its prior. */
struct BAYESIAN_ICP_EXPORT PoseMeasurement {
  /** Mean and covariances of the clouds' likelihood, as a Gaussian. In unmeasured
   * directions, the mean is the posterior's, and the standard deviation is
   * unmeasured_deviation times the prior's, so that the covariance can be inverted. */
  PoseEstimate estimate;
  /** Number of unmeasured directions, which the clouds do not determine, 0 to 6. It is
   * 6 without a measurement. */
  int num_unmeasured = 6;
};

/** \brief Remove the prior from a posterior. In information form, information and mean
 * of the prior are subtracted from those of the posterior, linearised at the posterior
 * mean.
 *
 * Fusing the result with the prior again gives the posterior. The result is accurate if
 * the posterior is nearly Gaussian.
 * \param[in] posterior mean and covariances
 * \param[in] prior with which \p posterior was sampled: PosteriorEstimate::prior, or
 *            getPrior() of the class
 * \return NaN if \p posterior has no finite mean and covariance, or \p prior no finite
 * mean and positive variances. The status is then InvalidInput if that of \p posterior
 * promises a mean. */
BAYESIAN_ICP_EXPORT PoseMeasurement
withoutPrior(const PoseEstimate& posterior, const Prior& prior);

/** \brief A Gaussian in all conventions.
 * \param[in] mean pose [m, rad]
 * \param[in] covariance about \p mean [m, rad]
 * \param[in] convention of \p covariance; the others follow from it to first order
 * \return status NotRun, which exports refuse: set the one that you want */
BAYESIAN_ICP_EXPORT PoseEstimate
estimateOf(const Vector6d& mean,
           const Matrix6d& covariance,
           CovarianceConvention convention);

/** \brief The prior as a Gaussian about its mean.
 * \return status Ok; InvalidInput unless \p prior has a finite mean and positive
 *         variances */
BAYESIAN_ICP_EXPORT PoseEstimate
estimateOf(const Prior& prior);

} // namespace bayesian_icp
