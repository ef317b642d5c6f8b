#pragma once

#include <pcl/registration/bayesian_icp.h>
#include <pcl/pcl_config.h> // for PCL_VERSION_COMPARE

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace pcl {

namespace bayesian_icp_detail {

/** The gate of an option and PCL's, whose default (the root of the largest double) is
 * none [m]. */
inline double
smallerGate(double gate, double pcl_gate)
{
  constexpr double no_gate = 1e18;
  return (std::abs(pcl_gate) < no_gate ? std::min(gate, std::abs(pcl_gate)) : gate);
}

/** Median of the points' largest |x|, |y|, |z| [m]; 0 if none is finite. As
 * bayesian_icp::usualCoordinate(), without a copy of the cloud. */
template <typename PointT>
double
usualCoordinate(const PointCloud<PointT>& cloud)
{
  std::vector<float> largest;
  largest.reserve(cloud.size());
  for (const auto& point : cloud)
    if (isXYZFinite(point))
      largest.push_back(point.getVector3fMap().cwiseAbs().maxCoeff());
  if (largest.empty())
    return (0.0);
  const auto middle = largest.begin() + largest.size() / 2;
  std::nth_element(largest.begin(), middle, largest.end());
  return (static_cast<double>(*middle));
}

} // namespace bayesian_icp_detail

template <typename PointSource, typename PointTarget, typename Scalar>
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    BayesianIterativeClosestPoint()
{
  reg_name_ = "BayesianIterativeClosestPoint";
  setOptions(options_);
}

// Not inline: PCL's function has threads only where it is compiled with OpenMP, as this
// library is and its users need not be.
template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::setNumberOfThreads(
    unsigned int nr_threads)
{
#if PCL_VERSION_COMPARE(>=, 1, 15, 0)
  Icp::setNumberOfThreads(nr_threads);
#endif
  options_.chains.num_threads = static_cast<int>(
      std::min<unsigned int>(nr_threads, std::numeric_limits<int>::max()));
  this->own_tree_->seeded->num_threads = options_.chains.num_threads;
  this->own_estimation_->num_threads = options_.chains.num_threads;
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::registerUsable(
    const IndicesConstPtr& usable, const Matrix4& guess)
{
  if (!use_mean_as_final_transformation_) {
    if (runIcp(guess))
      samplePosterior(usable, guess);
    return;
  }
  this->giveTargetToPlugins();
  samplePosterior(usable, guess);
  // Without ICP, and as long as there is no mean, the source stays at the guess.
  this->nr_iterations_ = 0;
  this->correspondences_->clear();
  this->converged_ = false;
  convergence_criteria_->setConvergenceState(
      Base::State::CONVERGENCE_CRITERIA_NOT_CONVERGED);
  final_transformation_ = guess;
  if (!moveToMean(*usable) &&
      estimate_.summary.status != bayesian_icp::Status::Cancelled)
    runIcp(guess);
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::runIcp(
    const Matrix4& guess)
{
  PointCloudSource moved; // the output may be the source, which the posterior needs
  if (!progress_callback_) {
    Icp::computeTransformation(moved, guess);
    return (true);
  }
  // PCL calls the visualizer in each iteration, and looks at the largest number of
  // iterations after it.
  bool is_cancelled = false;
  const auto visualize = this->update_visualizer_;
  const auto askAndVisualize = [&](const PointCloudSource& source,
                                   const Indices& source_indices,
                                   const PointCloudTarget& target,
                                   const Indices& target_indices) {
    if (visualize)
      visualize(source, source_indices, target, target_indices);
    is_cancelled = is_cancelled || !progress_callback_({0, 0, 0, 0});
    if (is_cancelled)
      convergence_criteria_->setMaximumIterations(0);
  };
  {
    using Visualizer = decltype(this->update_visualizer_);
    const bayesian_icp_detail::Substitution<Visualizer> asking(
        this->update_visualizer_, Visualizer(askAndVisualize));
    Icp::computeTransformation(moved, guess);
  }
  if (!is_cancelled)
    return (true);
  this->converged_ = false;
  auto& summary = estimate_.summary;
  if (summary.status == bayesian_icp::Status::NotRun) {
    summary.status = bayesian_icp::Status::Cancelled;
    summary.message = "interrupted before the first draw";
  }
  return (false);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::samplePosterior(
    const IndicesConstPtr& usable, const Matrix4& guess)
{
  const Eigen::Matrix4d initial = guess.template cast<double>();
  if (bayesian_icp_detail::isRigid(initial)) {
    Eigen::Matrix3Xd points = bayesian_icp_detail::pointMatrix(*input_, *usable);
    const double coordinate = std::max(bayesian_icp::usualCoordinate(points),
                                       bayesian_icp_detail::usualCoordinate(*target_));
    estimate_ =
        estimateByPreset(std::move(points), usable, bayesian_icp::poseOf(initial));
    bayesian_icp::doubtRounding(coordinate, options_, estimate_.summary);
  }
  else {
    keepFailure(false, "the initial guess is not a rotation and a translation");
  }
  reportStatus();
}

template <typename PointSource, typename PointTarget, typename Scalar>
bayesian_icp::PosteriorEstimate
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::estimateByPreset(
    Eigen::Matrix3Xd points, const IndicesConstPtr& usable, const Vector6d& start)
{
  bayesian_icp::Options options = options_;
  const auto refused = [](const char* reason) {
    bayesian_icp::PosteriorEstimate refusal;
    refusal.summary.status = bayesian_icp::Status::InvalidOptions;
    refusal.summary.message = reason;
    return (refusal);
  };
  if (options.preset == bayesian_icp::Preset::Calibrated) {
    if (is_scale_stated_)
      return (refused(
          "measurement_sigma and effective_points belong to presets paper and exact, "
          "but setMeasurementSigma or setEffectivePoints was called, and preset "
          "calibrated finds its scale itself; setOptions(getOptions()) undoes the "
          "call"));
    if (!hasPlainCorrespondences())
      PCL_WARN("[pcl::%s::computeTransformation] Rejectors, reciprocal pairs and "
               "searches of the user's own are for ICP alone with preset calibrated, "
               "which matches points to the target's surface.\n",
               getClassName().c_str());
    const auto prepared_target = prepared(searchedTargetPoints());
    prepared_source_ = prepared(std::move(points));
    prepared_target_ = prepared_target;
    return (bayesian_icp::estimatePosterior(
        prepared_source_, prepared_target_, start, options, progress_callback_));
  }
  const bool is_exact = options.preset == bayesian_icp::Preset::Exact;
  double& gate =
      is_exact ? options.exact.residual.max_distance : options.paper.max_distance;
  gate = bayesian_icp_detail::smallerGate(gate, corr_dist_threshold_);
  const bool may_drop_pairs =
      use_reciprocal_correspondence_ || !correspondence_rejectors_.empty();
  if (is_exact && may_drop_pairs && !std::isfinite(gate))
    return (refused(
        "preset exact with rejectors or reciprocal pairs needs a finite "
        "setMaxCorrespondenceDistance or exact.residual.max_distance: it is what a "
        "point without a pair costs, and without a cost the best pose has no pairs"));
  if (const auto tree = targetTree())
    return (bayesian_icp::estimatePosterior(
        points, *tree, start, options, progress_callback_));
  const auto search =
      this->makeCorrespondenceSearch(usable, std::min(gate, corr_dist_threshold_));
  return (bayesian_icp::estimatePosterior(
      points, *search, start, options, progress_callback_));
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::reportStatus() const
{
  const auto& summary = estimate_.summary;
  if (summary.status == bayesian_icp::Status::Doubtful ||
      summary.status == bayesian_icp::Status::NotMixed ||
      summary.status == bayesian_icp::Status::SeveralModes ||
      summary.status == bayesian_icp::Status::Diverged)
    PCL_WARN("[pcl::%s::computeTransformation] Posterior: %s.\n",
             getClassName().c_str(),
             summary.message.c_str());
  else if (summary.num_draws == 0)
    PCL_ERROR("[pcl::%s::computeTransformation] No posterior: %s.\n",
              getClassName().c_str(),
              summary.message.c_str());
}

template <typename PointSource, typename PointTarget, typename Scalar>
Eigen::Matrix3Xd
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::searchedTargetPoints()
    const
{
  Indices found;
  this->anyOfSearched([&found](index_t index) {
    found.push_back(index);
    return (false);
  });
  return (bayesian_icp_detail::pointMatrix(this->searchedCloud(), found));
}

template <typename PointSource, typename PointTarget, typename Scalar>
bayesian_icp::PreparedCloud
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::prepared(
    Eigen::Matrix3Xd points) const
{
  for (const auto& cloud : {prepared_target_, prepared_source_})
    if (points.cols() == cloud.points().cols() && points == cloud.points())
      return (cloud);
  return (bayesian_icp::PreparedCloud(std::move(points)));
}

template <typename PointSource, typename PointTarget, typename Scalar>
std::shared_ptr<const bayesian_icp::KdTree>
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::targetTree() const
{
  // The user's may be a ready tree, or one of a selection of the target.
  if (!hasPlainCorrespondences() || force_no_recompute_ ||
      correspondence_estimation_->getIndicesTarget())
    return (nullptr);
  const auto own = tree_ == this->own_tree_ ? this->own_tree_->seeded->get() : nullptr;
  // `paper` asks a tree, or a point representation, of the user's own itself.
  if (own || options_.preset == bayesian_icp::Preset::Paper)
    return (own);
  return (std::make_shared<const bayesian_icp::KdTree>(
      bayesian_icp_detail::pointMatrix<float>(*target_), options_.chains.num_threads));
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::moveToMean(
    const Indices& usable)
{
  if (!bayesian_icp::hasUsableMean(estimate_.summary.status))
    return (false);
  const Matrix4 mean =
      this->asEstimationAllows(usable, final_transformation_, getMeanTransformation());
  if (!mean.allFinite())
    return (false);
  final_transformation_ = mean;
  this->converged_ = true;
  return (true);
}

} // namespace pcl
