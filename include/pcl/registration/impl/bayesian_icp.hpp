#pragma once

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>
#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/impl/bayesian_icp_search.hpp>
#include <pcl/registration/impl/bayesian_icp_selection.hpp>
#include <pcl/registration/transformation_estimation_svd.h>

#include <algorithm>
#include <cmath>
#include <typeinfo>
#include <utility>

namespace pcl {

namespace bayesian_icp_detail {

/** Puts another value into a variable for the lifetime of this object. */
template <typename T>
class Substitution {
public:
  Substitution(T& variable, T value) : variable_(variable), original_(std::move(value))
  {
    std::swap(variable_, original_);
  }
  ~Substitution() { std::swap(variable_, original_); }
  Substitution(const Substitution&) = delete;
  Substitution&
  operator=(const Substitution&) = delete;

private:
  T& variable_;
  T original_;
};

/** The gate of an option and PCL's, whose default (the root of the largest double) is
 * none [m]. */
inline double
smallerGate(double gate, double pcl_gate)
{
  constexpr double no_gate = 1e18;
  return (std::abs(pcl_gate) < no_gate ? std::min(gate, std::abs(pcl_gate)) : gate);
}

/** Whether a search tree is PCL's own, with PCL's own idea of a point. */
template <typename PointT>
bool
isDefaultTree(const search::KdTree<PointT>& tree)
{
  const auto& representation = *tree.getPointRepresentation();
  return (typeid(tree) == typeid(search::KdTree<PointT>) &&
          typeid(representation) == typeid(DefaultPointRepresentation<PointT>));
}

/** Whether a transformation is a rotation and a translation, to the accuracy of float.
 */
inline bool
isRigid(const Eigen::Matrix4d& transformation)
{
  constexpr double tolerance = 1e-3;
  const Eigen::Matrix3d R = transformation.topLeftCorner<3, 3>();
  return ((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < tolerance &&
          R.determinant() > 0.0);
}

} // namespace bayesian_icp_detail

template <typename PointSource, typename PointTarget, typename Scalar>
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    BayesianIterativeClosestPoint()
{
  reg_name_ = "BayesianIterativeClosestPoint";
}

template <typename PointSource, typename PointTarget, typename Scalar>
bayesian_icp::PoseMatrix
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::getChain(
    std::size_t index) const
{
  return (index < estimate_.chains.size() ? estimate_.chains[index].draws
                                          : Samples(0, 6));
}

template <typename PointSource, typename PointTarget, typename Scalar>
typename BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::Matrix4
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::getMeanTransformation()
    const
{
  return (bayesian_icp::matrixOf(estimate_.summary.mean).template cast<Scalar>());
}

template <typename PointSource, typename PointTarget, typename Scalar>
double
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::getFitnessScore(
    double max_range)
{
  PointCloudSource moved;
  transformPointCloud(*input_, moved, final_transformation_);
  Indices index(1);
  std::vector<float> squared_distance(1);
  double sum = 0.0;
  std::size_t num_in_range = 0;
  PointTarget query;
  for (const auto& point : moved) {
    if (!bayesian_icp_detail::canBeQueried(point.getVector3fMap()))
      continue;
    copyPoint(point, query);
    if (tree_->nearestKSearch(query, 1, index, squared_distance) > 0 &&
        squared_distance[0] <= max_range) {
      sum += squared_distance[0];
      ++num_in_range;
    }
  }
  return (num_in_range > 0 ? sum / static_cast<double>(num_in_range)
                           : std::numeric_limits<double>::max());
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::computeTransformation(
    PointCloudSource& output, const Matrix4& guess)
{
  estimate_ = bayesian_icp::PosteriorEstimate();
  const PointCloudSourceConstPtr whole = input_;
  const bayesian_icp_detail::SourceSelection<PointSource, PointTarget, Scalar>
      selection(*correspondence_estimation_, *whole, *indices_);
  const Eigen::Matrix4f float_guess = guess.template cast<float>();
  const Indices usable =
      bayesian_icp_detail::usablePoints(*whole, selection.indices(), float_guess);
  if (!float_guess.allFinite() || !targetIsUsable() ||
      usable.size() < static_cast<std::size_t>(min_number_correspondences_)) {
    failWithoutCorrespondences(output, guess);
    return;
  }

  // PCL's ICP takes all points of input_, and writes to output while it still needs
  // them if both are one cloud (icp.align(*source)).
  PointCloudSourceConstPtr source = whole;
  const bool is_subset = !bayesian_icp_detail::isWholeCloud(usable, whole->size());
  if (is_subset || &output == whole.get()) {
    PointCloudSourcePtr copy(new PointCloudSource);
    copyPointCloud(*whole, usable, *copy);
    source = copy;
  }
  PointCloudSource scratch;
  {
    const bayesian_icp_detail::Substitution<PointCloudSourceConstPtr> input(input_,
                                                                            source);
    Base::computeTransformation(source == whole ? output : scratch, guess);
    samplePosterior(source, guess);
  }
  if (is_subset)
    for (auto& correspondence : *correspondences_)
      correspondence.index_query = usable[correspondence.index_query];
  const bool is_moved_to_mean =
      use_mean_as_final_transformation_ && moveToMean(*source);
  if (source != whole || is_moved_to_mean) {
    output = *whole;
    transformCloud(*whole, output, final_transformation_);
  }
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::targetIsUsable() const
{
  for (const auto& point : *target_)
    if (isXYZFinite(point))
      return (true);
  return (false);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    failWithoutCorrespondences(PointCloudSource& output, const Matrix4& guess)
{
  const bool is_guess_finite = guess.template cast<float>().allFinite();
  auto& summary = estimate_.summary;
  summary.status = is_guess_finite ? bayesian_icp::Status::TooFewCorrespondences
                                   : bayesian_icp::Status::InvalidInput;
  summary.message = is_guess_finite ? "fewer finite points than the registration needs"
                                    : "the initial guess is not finite";
  PCL_ERROR("[pcl::%s::computeTransformation] No registration: %s.\n",
            getClassName().c_str(),
            summary.message.c_str());
  nr_iterations_ = 0;
  converged_ = false;
  correspondences_->clear();
  convergence_criteria_->setConvergenceState(
      registration::DefaultConvergenceCriteria<
          Scalar>::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES);
  output = *input_;
  if (is_guess_finite) {
    final_transformation_ = guess;
    transformCloud(*input_, output, guess);
  }
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::samplePosterior(
    const PointCloudSourceConstPtr& source, const Matrix4& guess)
{
  auto& summary = estimate_.summary;
  if (convergence_criteria_->getConvergenceState() ==
      registration::DefaultConvergenceCriteria<
          Scalar>::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES) {
    summary.status = bayesian_icp::Status::TooFewCorrespondences;
    summary.message = "ICP found too few correspondences within the maximum "
                      "correspondence distance";
    return; // ICP has reported it
  }
  const Eigen::Matrix4d initial = guess.template cast<double>();
  if (!bayesian_icp_detail::isRigid(initial)) {
    summary.status = bayesian_icp::Status::InvalidInput;
    summary.message = "the initial guess is not a rotation and a translation";
    PCL_ERROR("[pcl::%s::computeTransformation] No posterior: %s.\n",
              getClassName().c_str(),
              summary.message.c_str());
    return;
  }
  estimate_ = estimateByPreset(source, bayesian_icp::poseOf(initial));
  reportStatus();
}

template <typename PointSource, typename PointTarget, typename Scalar>
bayesian_icp::PosteriorEstimate
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::estimateByPreset(
    const PointCloudSourceConstPtr& source, const Vector6d& start)
{
  const auto points = bayesian_icp_detail::pointMatrix(*source);
  bayesian_icp::Options options = options_;
  options.exact.residual.max_distance = bayesian_icp_detail::smallerGate(
      options.exact.residual.max_distance, corr_dist_threshold_);
  if (options.preset == bayesian_icp::Preset::Calibrated) {
    if (!hasPlainCorrespondences())
      PCL_WARN("[pcl::%s::computeTransformation] Rejectors, reciprocal pairs and "
               "searches of the user's own are for ICP alone with preset calibrated, "
               "which matches points to the target's surface.\n",
               getClassName().c_str());
    return (bayesian_icp::estimatePosterior(
        points, searchedTargetPoints(), start, options, progress_callback_));
  }
  if (options.preset == bayesian_icp::Preset::Exact && hasPlainCorrespondences() &&
      isTreeOfWholeTarget())
    return (bayesian_icp::estimatePosterior(
        points,
        bayesian_icp::KdTree(
            bayesian_icp_detail::pointMatrix(*target_).template cast<float>(),
            options.chains.num_threads),
        start,
        options,
        progress_callback_));
  return (bayesian_icp::estimatePosterior(
      points, *makeCorrespondenceSearch(source), start, options, progress_callback_));
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
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::hasDefaultEstimation()
    const
{
  const auto& estimation = *correspondence_estimation_;
  if (typeid(estimation) !=
      typeid(registration::CorrespondenceEstimation<PointSource, PointTarget, Scalar>))
    return (false);
  return (bayesian_icp_detail::isDefaultTree(*tree_) &&
          (!use_reciprocal_correspondence_ ||
           bayesian_icp_detail::isDefaultTree(*tree_reciprocal_)));
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    hasPlainCorrespondences() const
{
  return (hasDefaultEstimation() && correspondence_rejectors_.empty() &&
          !use_reciprocal_correspondence_);
}

template <typename PointSource, typename PointTarget, typename Scalar>
Eigen::Matrix3Xd
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::searchedTargetPoints()
    const
{
  using namespace bayesian_icp_detail;
  const bool is_ready_tree = force_no_recompute_ && tree_->getInputCloud();
  const auto& cloud = is_ready_tree ? *tree_->getInputCloud() : *target_;
  const IndicesConstPtr selected =
      is_ready_tree ? tree_->getIndices()
                    : IndicesConstPtr(correspondence_estimation_->getIndicesTarget());
  if (!selected || selected->empty())
    return (pointMatrix(cloud));
  PointCloud<PointTarget> selection;
  copyPointCloud(cloud, *selected, selection);
  return (pointMatrix(selection));
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::isTreeOfWholeTarget()
    const
{
  return (!force_no_recompute_ && !correspondence_estimation_->getIndicesTarget());
}

template <typename PointSource, typename PointTarget, typename Scalar>
std::unique_ptr<bayesian_icp::CorrespondenceSearch>
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    makeCorrespondenceSearch(const PointCloudSourceConstPtr& source)
{
  using namespace bayesian_icp_detail;
  std::unique_ptr<KdTreeSearch<PointSource, PointTarget>> default_search;
  if (hasDefaultEstimation())
    default_search.reset(new KdTreeSearch<PointSource, PointTarget>(
        tree_,
        target_,
        corr_dist_threshold_,
        use_reciprocal_correspondence_ ? source : PointCloudSourceConstPtr()));
  if (default_search && correspondence_rejectors_.empty())
    return default_search;

  typename PluginSearch<PointSource, PointTarget, Scalar>::Plugins plugins;
  plugins.default_search = std::move(default_search);
  plugins.estimation = correspondence_estimation_;
  plugins.rejectors = correspondence_rejectors_;
  plugins.max_distance = corr_dist_threshold_;
  plugins.is_reciprocal = use_reciprocal_correspondence_;
  plugins.source_has_normals = source_has_normals_;
  plugins.transform = [this](const PointCloudSource& in,
                             PointCloudSource& out,
                             const Matrix4& T) { transformCloud(in, out, T); };
  return (std::unique_ptr<bayesian_icp::CorrespondenceSearch>(
      new PluginSearch<PointSource, PointTarget, Scalar>(plugins, source, target_)));
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
BayesianIterativeClosestPoint<PointSource, PointTarget, Scalar>::moveToMean(
    const PointCloudSource& source)
{
  if (!bayesian_icp::hasUsableMean(estimate_.summary.status))
    return (false);
  Matrix4 mean = getMeanTransformation();
  const auto& estimation = *transformation_estimation_;
  if (typeid(estimation) !=
      typeid(registration::
                 TransformationEstimationSVD<PointSource, PointTarget, Scalar>)) {
    // The estimation may allow some motions only (2-D, translation): ask it for the
    // motion that brings the source from ICP's result to the mean.
    PointCloudSource at_result = source, at_mean = source;
    transformCloud(source, at_result, final_transformation_);
    transformCloud(source, at_mean, mean);
    PointCloudTarget goal;
    copyPointCloud(at_mean, goal);
    Matrix4 motion = Matrix4::Identity();
    transformation_estimation_->estimateRigidTransformation(at_result, goal, motion);
    mean = motion * final_transformation_;
  }
  if (!mean.allFinite())
    return (false);
  final_transformation_ = mean;
  return (true);
}

} // namespace pcl
