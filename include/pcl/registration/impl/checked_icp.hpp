#pragma once

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>
#include <pcl/registration/checked_icp.h>
#include <pcl/registration/impl/bayesian_icp_selection.hpp>
#include <pcl/registration/transformation_estimation_svd.h>

#include <algorithm>
#include <limits>
#include <typeinfo>
#include <utility>
#include <vector>

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

/** Whether a search tree answers as PCL's own, with PCL's own idea of a point. */
template <typename PointT>
bool
isDefaultTree(const search::KdTree<PointT>& tree)
{
  return ((typeid(tree) == typeid(search::KdTree<PointT>) ||
           typeid(tree) == typeid(SeededKdTree<PointT>)) &&
          isDefault(*tree.getPointRepresentation()));
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

template <typename PointSource, typename PointTarget, typename Scalar>
void
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::setInputTarget(
    const PointCloudTargetConstPtr& cloud)
{
  const auto is_too_far = [](const PointTarget& point) {
    return (isXYZFinite(point) && !canBeQueried(point.getVector3fMap()));
  };
  if (!cloud || std::none_of(cloud->begin(), cloud->end(), is_too_far)) {
    Base::setInputTarget(cloud);
    return;
  }
  const PointCloudTargetPtr usable(new PointCloudTarget(*cloud));
  for (auto& point : *usable)
    if (is_too_far(point))
      point.getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
  usable->is_dense = false;
  Base::setInputTarget(usable);
}

template <typename PointSource, typename PointTarget, typename Scalar>
double
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::getFitnessScore(
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
    if (!canBeQueried(point.getVector3fMap()))
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
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::computeTransformation(
    PointCloudSource& output, const Matrix4& guess)
{
  forgetResult();
  const PointCloudSourceConstPtr whole = input_;
  const SourceSelection<PointSource, PointTarget, Scalar> selection(
      *correspondence_estimation_, *whole, *indices_);
  const Eigen::Matrix4f float_guess = guess.template cast<float>();
  const Indices usable = usablePoints(*whole, selection.indices(), float_guess);
  if (!float_guess.allFinite() || !targetIsUsable() ||
      usable.size() < static_cast<std::size_t>(min_number_correspondences_)) {
    failWithoutCorrespondences(output, guess);
    return;
  }

  // PCL's ICP takes all points of input_, and writes to output while it still needs
  // them if both are one cloud (icp.align(*source)).
  PointCloudSourceConstPtr source = whole;
  const bool is_subset = !isWholeCloud(usable, whole->size());
  if (is_subset || &output == whole.get()) {
    PointCloudSourcePtr copy(new PointCloudSource);
    copyPointCloud(*whole, usable, *copy);
    source = copy;
  }
  PointCloudSource scratch;
  bool is_output_moved = false;
  {
    const Substitution<PointCloudSourceConstPtr> input(input_, source);
    is_output_moved = registerUsable(source, source == whole ? output : scratch, guess);
  }
  if (is_subset)
    for (auto& correspondence : *correspondences_)
      correspondence.index_query =
          usable[static_cast<std::size_t>(correspondence.index_query)];
  if (source != whole || !is_output_moved) {
    output = *whole;
    transformCloud(*whole, output, final_transformation_);
  }
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::targetIsUsable() const
{
  for (const auto& point : *target_)
    if (isXYZFinite(point))
      return (true);
  return (false);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    failWithoutCorrespondences(PointCloudSource& output, const Matrix4& guess)
{
  const bool is_guess_finite = guess.template cast<float>().allFinite();
  const char* reason = is_guess_finite
                           ? "fewer finite points than the registration needs"
                           : "the initial guess is not finite";
  PCL_ERROR("[pcl::%s::computeTransformation] No registration: %s.\n",
            getClassName().c_str(),
            reason);
  keepFailure(is_guess_finite, reason);
  nr_iterations_ = 0;
  converged_ = false;
  correspondences_->clear();
  convergence_criteria_->setConvergenceState(
      State::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES);
  output = *input_;
  if (is_guess_finite) {
    final_transformation_ = guess;
    transformCloud(*input_, output, guess);
  }
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::hasDefaultEstimation()
    const
{
  const auto& estimation = *correspondence_estimation_;
  if (typeid(estimation) !=
      typeid(registration::CorrespondenceEstimation<PointSource, PointTarget, Scalar>))
    return (false);
  return (isDefaultTree(*tree_) &&
          (!use_reciprocal_correspondence_ || isDefaultTree(*tree_reciprocal_)));
}

template <typename PointSource, typename PointTarget, typename Scalar>
std::unique_ptr<PairSearch<PointTarget>>
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    makeCorrespondenceSearch(const PointCloudSourceConstPtr& source)
{
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
  return (std::unique_ptr<PairSearch<PointTarget>>(
      new PluginSearch<PointSource, PointTarget, Scalar>(plugins, source, target_)));
}

template <typename PointSource, typename PointTarget, typename Scalar>
typename CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::Matrix4
CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>::asEstimationAllows(
    const PointCloudSource& source, const Matrix4& from, const Matrix4& to)
{
  const auto& estimation = *transformation_estimation_;
  if (typeid(estimation) ==
      typeid(
          registration::TransformationEstimationSVD<PointSource, PointTarget, Scalar>))
    return (to);
  PointCloudSource there = source, here = source;
  transformCloud(source, here, from);
  transformCloud(source, there, to);
  PointCloudTarget goal;
  copyPointCloud(there, goal);
  Matrix4 motion = Matrix4::Identity();
  estimation.estimateRigidTransformation(here, goal, motion);
  return (motion * from);
}

} // namespace bayesian_icp_detail
} // namespace pcl
