/** \file
 * \brief Entry point without PCL: computes a posterior from points and a search.
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/kd_tree.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/prepared_cloud.h>
#include <bayesian_icp/prior.h>
#include <bayesian_icp/summary.h>

namespace bayesian_icp {

/** \brief The draws and their summary. */
struct PosteriorEstimate {
  Summary summary;
  /** Every chain, including the diverged ones. */
  std::vector<Chain> chains;
  /** Draws of the chains that did not diverge, chain after chain. */
  PoseMatrix samples;
  /** The prior that was sampled with, for withoutPrior(). Its mean is NaN without
   * draws.
   */
  Prior prior{PriorOptions().mean, PriorOptions().variance};
};

/** \brief Smallest number of source points that must have a correspondence at the
 * initial guess. */
constexpr std::size_t min_correspondences = 3;

/** \brief Sample the posterior of the source-to-target pose with options.preset.
 * \param[in] source_points 3 x n, finite, source frame [m]
 * \param[in] search finds correspondences in the target, within its gate. Preset
 *            `calibrated` needs the target's points and returns Status::InvalidOptions
 *            here
 * \param[in] initial_pose start of the chains, and mean of the prior unless the options
 *            state one [m, rad]
 * \param[in] options preset, prior, chains and all other options of the preset
 * \param[in] progress called after every step; returns false to cancel
 * \return an estimate whose summary.status states the outcome. Bad options or input
 * result in a status, not in an exception. Exceptions of \p search and \p progress, and
 * std::bad_alloc, pass through. */
BAYESIAN_ICP_EXPORT PosteriorEstimate
estimatePosterior(const Eigen::Matrix3Xd& source_points,
                  const CorrespondenceSearch& search,
                  const Vector6d& initial_pose,
                  const Options& options,
                  const ProgressCallback& progress = ProgressCallback());

/** \brief The same for clouds given by their points, or by PreparedClouds that are kept
 * for other registrations. This is the only overload for preset `calibrated` that keeps
 * all digits of far coordinates.
 *
 * \param[in] source finite points in the source frame [m], with what has been prepared
 *            for them
 * \param[in] target the same in the target frame [m]
 * \param[in] initial_pose as above
 * \param[in] options as above; any preset
 * \param[in] progress as above
 * \return as above. It does not depend on earlier uses of the clouds. */
BAYESIAN_ICP_EXPORT PosteriorEstimate
estimatePosterior(const PreparedCloud& source,
                  const PreparedCloud& target,
                  const Vector6d& initial_pose,
                  const Options& options,
                  const ProgressCallback& progress = ProgressCallback());

/** \brief The same with nearest neighbours in \p target_tree, within the max_distance
 * of preset `exact` or `paper`. As with a target cloud, preset `exact` is fast and
 * accepts residuals other than Residual::PointToPoint (normals and covariances are
 * those of patches of the target). Preset `calibrated` uses the tree's points. */
BAYESIAN_ICP_EXPORT PosteriorEstimate
estimatePosterior(const Eigen::Matrix3Xd& source_points,
                  const KdTree& target_tree,
                  const Vector6d& initial_pose,
                  const Options& options,
                  const ProgressCallback& progress = ProgressCallback());

/** \brief A typical coordinate of points: the median of their largest |x|, |y|, |z|
 * [m]; 0 if none is finite.
 * \param[in] points 3 x n; non-finite points are ignored */
BAYESIAN_ICP_EXPORT double
usualCoordinate(const Eigen::Matrix3Xd& points);

/** \brief Check whether 32-bit coordinates are too coarse for the noise. If so, add
 * this to the message, and turn Ok into Doubtful.
 * \param[in] coordinate usualCoordinate() of the clouds, the larger one [m]
 * \param[in] options of the estimate; the preset's measurement_sigma is the noise if \p
 *            summary has none
 * \param[in,out] summary of an estimate; it is unchanged if nothing was sampled */
BAYESIAN_ICP_EXPORT void
doubtRounding(double coordinate, const Options& options, Summary& summary);

} // namespace bayesian_icp
