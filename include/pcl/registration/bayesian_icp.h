/** \file
 * \brief Drop-in replacement for pcl::IterativeClosestPoint that also estimates the
 * uncertainty of the pose.
 */
#pragma once

#include <bayesian_icp/pipeline.h>

#include <pcl/registration/impl/checked_icp.hpp>

namespace pcl {

/** \brief Iterative closest point with the posterior of its transformation.
 *
 * align() first runs pcl::IterativeClosestPoint. Final transformation, output,
 * convergence and correspondences are those of that class to the last bit (except with
 * indices, see below). Unless the user installs a search tree, this library's tree
 * finds the same pairs. align() then samples the posterior of the source-to-target pose
 * with preconditioned Langevin chains over mini-batches of the source (Maken, Ramos,
 * Ott: Estimating Motion Uncertainty with Bayesian ICP, ICRA 2020). Preset::Exact also
 * has other kinds of steps.
 *
 * The default, Preset::Calibrated, estimates the scale from the clouds.
 * getSummary().data states how well they determine the pose in each direction.
 * Distances are measured to the surface of the target points that the object searches:
 * all points, those of the indices set on its estimation, or those of a ready tree.
 * Rejectors, reciprocity, the user's own estimation and the maximum correspondence
 * distance then apply to ICP only, because the posterior weights each point by its
 * distance in units of the noise.
 *
 * With Preset::Exact, draws are correct for the stated measurement sigma, effective
 * points, gate and prior. Preset::Paper is the paper's Algorithm 1, literally. Both use
 * the correspondence estimation, rejectors, search tree and maximum correspondence
 * distance of the object. They apply rejectors and the user's own correspondence
 * estimation to each mini-batch.
 *
 * Poses are (x, y, z, roll, pitch, yaw) [m, rad] of the complete source-to-target
 * transformation, guess included. The translation is in the target frame, and R =
 * Rz(yaw) Ry(pitch) Rx(roll). getSummary().status states whether the posterior can be
 * trusted; hasConverged() does not, it keeps ICP's meaning.
 *
 * Unlike pcl::IterativeClosestPoint of PCL 1.13, this class skips source points that
 * are not finite (or further out than 1e18 m) and keeps them in the output. The
 * estimate uses only the given indices; an empty list of them is the whole cloud (the
 * output is the whole cloud, as in PCL; ICP of PCL registers the whole cloud). A source
 * or target that is empty, null or not set, and indices outside their cloud, give
 * Status::InvalidInput. Exceptions of callbacks and plug-ins, and std::bad_alloc, pass
 * through align(): then hasConverged() is false and the status NotRun. As in PCL, use
 * one object from one thread at a time.
 *
 * \tparam Scalar float or double, type of the transformations
 * \ingroup registration
 */
template <typename PointSource, typename PointTarget, typename Scalar = float>
class BayesianIterativeClosestPoint
: public bayesian_icp_detail::
      CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar> {
public:
  using Icp = IterativeClosestPoint<PointSource, PointTarget, Scalar>;
  using Base = bayesian_icp_detail::
      CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>;
  using Ptr = shared_ptr<BayesianIterativeClosestPoint>;
  using ConstPtr = shared_ptr<const BayesianIterativeClosestPoint>;
  using Matrix4 = typename Base::Matrix4;
  using PointCloudSource = typename Base::PointCloudSource;
  using PointCloudSourceConstPtr = typename Base::PointCloudSourceConstPtr;
  using PointCloudTarget = typename Base::PointCloudTarget;
  /** Each row is one draw: x y z roll pitch yaw [m, rad]. */
  using Samples = bayesian_icp::PoseMatrix;
  using Vector6d = bayesian_icp::Vector6d;
  using Matrix6d = bayesian_icp::Matrix6d;

  BayesianIterativeClosestPoint();

  /** \name Posterior of the last align(). Empty or NaN before it, and if it failed.
   * \{ */

  /** \brief Draws of all chains that did not diverge, chain after chain. */
  const Samples&
  getSamples() const
  {
    return (estimate_.samples);
  }

  /** \brief Draws of chain \p index, diverged or not. Empty if there is no such chain.
   */
  Samples
  getChain(std::size_t index) const
  {
    return (index < estimate_.chains.size() ? estimate_.chains[index].draws
                                            : Samples(0, 6));
  }

  /** \brief Whether chain \p index ran away or became non-finite. getSamples() leaves
   * out the draws of such a chain. False if there is no such chain. */
  bool
  hasChainDiverged(std::size_t index) const
  {
    return (index < estimate_.chains.size() && estimate_.chains[index].diverged);
  }

  /** \brief Posterior mean pose [m, rad]: bayesian_icp::meanPose() of the draws. */
  Vector6d
  getMean() const
  {
    return (estimate_.summary.mean);
  }

  /** \brief T_target_source of getMean(). Where Scalar is float, its rounding moves
   * points by 1e-7 of their distance from the origin: getMean() is in double. */
  Matrix4
  getMeanTransformation() const
  {
    return (bayesian_icp::matrixOf(estimate_.summary.mean).template cast<Scalar>());
  }

  /** \brief Covariance of the draws about getMean(). The default convention is that of
   * the parameters (x, y, z, roll, pitch, yaw) [m, rad]. */
  Matrix6d
  getCovariance(bayesian_icp::CovarianceConvention convention =
                    bayesian_icp::CovarianceConvention::Parameters) const
  {
    return (estimate_.summary.covariance(convention));
  }

  /** \brief The prior of the draws, as bayesian_icp::withoutPrior() needs it. */
  const bayesian_icp::Prior&
  getPrior() const
  {
    return (estimate_.prior);
  }

  /** \brief Status, marginals, R-hat and effective sample sizes. */
  const bayesian_icp::Summary&
  getSummary() const
  {
    return (estimate_.summary);
  }
  /** \} */

  /** \name Options of the posterior
   * See bayesian_icp::Options for units and ranges. If a value is out of range, align()
   * reports Status::InvalidOptions.
   * \{ */

  /** \brief Set all options, including those without a setter here. Options of another
   * preset than the chosen one have no effect. */
  void
  setOptions(const bayesian_icp::Options& options)
  {
    options_ = options;
    is_scale_stated_ = false;
    this->own_tree_->seeded->num_threads = options.chains.num_threads;
    this->own_estimation_->num_threads = options.chains.num_threads;
  }

  const bayesian_icp::Options&
  getOptions() const
  {
    return (options_);
  }

  /** \brief Select which posterior is sampled. Each preset has options of its own: see
   * bayesian_icp::Options. */
  void
  setPreset(bayesian_icp::Preset preset)
  {
    options_.preset = preset;
  }

  void
  setNumberOfChains(int num_chains)
  {
    options_.chains.num_chains = num_chains;
  }

  /** \brief Set the total number of draws kept, over all chains. 1000 are usually
   * enough for Status::Ok, fewer than 400 never. */
  void
  setNumberOfSamples(int num_draws)
  {
    options_.chains.num_draws = num_draws;
  }

  /** \brief Set the prior's mean pose [m, rad] and variances [m^2, rad^2], in the order
   * of the pose. By default the mean is the guess and each variance is 0.125. */
  void
  setPrior(const Vector6d& mean, const Vector6d& variance)
  {
    options_.prior.mean = mean;
    options_.prior.variance = variance;
  }

  /** \brief Set the point whose translation the prior describes. Automatic means the
   * origin. With preset `calibrated` it means the source's centroid if the cloud is far
   * from the origin for its size: see bayesian_icp::priorFrameOf(). */
  void
  setPriorFrame(bayesian_icp::PriorFrame frame)
  {
    options_.prior.frame = frame;
  }

  /** \brief Set N of eq. (5), for presets `paper` and `exact`. Preset `calibrated`
   * estimates its scale itself. With it, align() then reports Status::InvalidOptions
   * until setOptions() is called. setOptions(getOptions()) changes nothing else. */
  void
  setEffectivePoints(double effective_points)
  {
    options_.paper.scale.effective_points = effective_points;
    options_.exact.scale.effective_points = effective_points;
    is_scale_stated_ = true;
  }

  /** \brief Set sigma, the standard deviation of a point-to-point distance [m], for the
   * same presets as setEffectivePoints(). */
  void
  setMeasurementSigma(double sigma)
  {
    options_.paper.scale.measurement_sigma = sigma;
    options_.exact.scale.measurement_sigma = sigma;
    is_scale_stated_ = true;
  }

  void
  setSeed(std::uint64_t seed)
  {
    options_.chains.seed = seed;
  }

  /** \brief Set the number of threads of ICP and of the posterior. 0, the default,
   * means OpenMP's number of threads. No result depends on it. If the user installs a
   * correspondence estimation, ICP uses the threads of that estimation. With PCL 1.15
   * and later this function also sets those, if the estimation is installed before the
   * call. */
  void
  setNumberOfThreads(unsigned int nr_threads = 0);

  /** \brief Set a function that is called after every step of the chains and, with
   * zeros, in every iteration of ICP. It returns false to cancel. */
  void
  setProgressCallback(const bayesian_icp::ProgressCallback& callback)
  {
    progress_callback_ = callback;
  }

  /** \brief Use the posterior mean as the final transformation (and move the output
   * cloud by it) if the status is Ok, Doubtful or NotMixed.
   *
   * ICP does not run then: there are no correspondences, and hasConverged() is true.
   * With any other status except Cancelled, ICP runs as without this setting. If the
   * user has set a transformation estimation that knows some motions only, the final
   * transformation is the nearest one to the mean that it knows. If it knows none,
   * there is a warning and ICP runs. getConvergenceState() is that of ICP, which has
   * not converged. The posterior does not depend on this setting. */
  void
  setUseMeanAsFinalTransformation(bool use_mean)
  {
    use_mean_as_final_transformation_ = use_mean;
  }

  bool
  getUseMeanAsFinalTransformation() const
  {
    return (use_mean_as_final_transformation_);
  }
  /** \} */

  using Base::convergence_criteria_; // public in PCL's class, too
  using Base::getClassName;

protected:
  using Base::corr_dist_threshold_;
  using Base::correspondence_estimation_;
  using Base::correspondence_rejectors_;
  using Base::final_transformation_;
  using Base::force_no_recompute_;
  using Base::input_;
  using Base::reg_name_;
  using Base::target_;
  using Base::tree_;
  using Base::use_reciprocal_correspondence_;

  void
  forgetResult() override
  {
    estimate_ = bayesian_icp::PosteriorEstimate();
  }

  /** \brief ICP, then the posterior. */
  void
  registerUsable(const IndicesConstPtr& usable, const Matrix4& guess) override;

  void
  keepFailure(bool is_input_valid, const char* reason) override
  {
    estimate_.summary.status = is_input_valid
                                   ? bayesian_icp::Status::TooFewCorrespondences
                                   : bayesian_icp::Status::InvalidInput;
    estimate_.summary.message = reason;
  }

private:
  /** \return false if the progress callback has cancelled it */
  bool
  runIcp(const Matrix4& guess);

  void
  samplePosterior(const IndicesConstPtr& usable, const Matrix4& guess);

  /** \param[in] usable indices of the source's \p points */
  bayesian_icp::PosteriorEstimate
  estimateByPreset(Eigen::Matrix3Xd points,
                   const IndicesConstPtr& usable,
                   const Vector6d& start);

  /** \brief Whether the pairs are exactly those of the nearest points. */
  bool
  hasPlainCorrespondences() const
  {
    return (this->hasDefaultEstimation() && correspondence_rejectors_.empty() &&
            !use_reciprocal_correspondence_);
  }

  /** \brief The finite target points that the search tree finds. */
  Eigen::Matrix3Xd
  searchedTargetPoints() const;

  /** \brief The cloud of the last estimate that has these \p points, or a new one. In
   * odometry, the target is the previous source. */
  bayesian_icp::PreparedCloud
  prepared(Eigen::Matrix3Xd points) const;

  void
  reportStatus() const;

  /** \brief This library's tree over the whole target if presets `exact` and `paper`
   * may search it; null if they must use what the user has installed. */
  std::shared_ptr<const bayesian_icp::KdTree>
  targetTree() const;

  bool
  moveToMean(const Indices& usable);

  bayesian_icp::Options options_;
  /** Whether a setter has changed the scale since setOptions(). */
  bool is_scale_stated_ = false;
  bayesian_icp::ProgressCallback progress_callback_;
  bayesian_icp::PosteriorEstimate estimate_;
  bayesian_icp::PreparedCloud prepared_source_{Eigen::Matrix3Xd(3, 0)};
  bayesian_icp::PreparedCloud prepared_target_{Eigen::Matrix3Xd(3, 0)};
  bool use_mean_as_final_transformation_ = false;
};

} // namespace pcl

#include <pcl/registration/impl/bayesian_icp.hpp>

#if !defined(PCL_NO_PRECOMPILE) && !defined(PCL_REGISTRATION_BAYESIAN_ICP_CPP_)
#define PCL_BAYESIAN_ICP_DECLARE(PointT, Scalar)                                       \
  extern template class pcl::BayesianIterativeClosestPoint<PointT, PointT, Scalar>;
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_DECLARE, float)
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_DECLARE, double)
#undef PCL_BAYESIAN_ICP_DECLARE
#endif
