#pragma once

#include <bayesian_icp/pose.h>

#include <pcl/registration/stochastic_gradient_icp.h>

#include <algorithm>
#include <cmath>

namespace pcl {

template <typename PointSource, typename PointTarget, typename Scalar>
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    StochasticGradientDescentIterativeClosestPoint()
{
  reg_name_ = "StochasticGradientDescentIterativeClosestPoint";
  setOptions(Options());
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    setOptions(const Options& options)
{
  options_ = options;
  max_iterations_ = options.max_iterations;
  transformation_epsilon_ = options.translation_epsilon * options.translation_epsilon;
  transformation_rotation_epsilon_ = std::cos(options.rotation_epsilon);
}

template <typename PointSource, typename PointTarget, typename Scalar>
bayesian_icp::StochasticGradientIcpOptions
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    getOptions() const
{
  Options options = options_;
  options.max_iterations = std::max(max_iterations_, 1); // 0 is once in PCL, too
  options.translation_epsilon = std::sqrt(transformation_epsilon_);
  const double cosine = transformation_rotation_epsilon_ > 0.0
                            ? transformation_rotation_epsilon_
                            : 1.0 - transformation_epsilon_; // as in PCL's ICP
  options.rotation_epsilon = std::acos(std::min(std::max(cosine, -1.0), 1.0));
  return (options);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    registerUsable(const IndicesConstPtr& usable, const Matrix4& guess)
{
  nr_iterations_ = 0;
  converged_ = false;
  final_transformation_ = guess;
  transformation_ = previous_transformation_ = Matrix4::Identity();
  correspondences_->clear();
  const Eigen::Matrix4d initial = guess.template cast<double>();
  const Options options = getOptions();
  if (bayesian_icp_detail::isRigid(initial) && options.validate().empty()) {
    this->giveTargetToPlugins();
    const auto search =
        this->makeCorrespondenceSearch(usable, this->corr_dist_threshold_);
    bool is_in_range = true;
    result_ = bayesian_icp::stochasticGradientIcp(
        bayesian_icp_detail::pointMatrix(*input_, *usable),
        *search,
        bayesian_icp::poseOf(initial),
        options,
        [&](int iteration, const bayesian_icp::Vector6d& pose) {
          is_in_range = takeStep(*search, *usable, pose);
          return (is_in_range &&
                  (!progress_callback_ || progress_callback_(iteration, pose)));
        });
    if (!is_in_range)
      result_.end = bayesian_icp::DescentEnd::Diverged;
    if (nr_iterations_ > 0) {
      const Matrix4 allowed =
          this->asEstimationAllows(*usable, guess, final_transformation_);
      if (allowed.allFinite())
        final_transformation_ = allowed;
    }
    findPairs(*search, *usable);
  }
  publishEnd();
}

template <typename PointSource, typename PointTarget, typename Scalar>
bool
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    takeStep(const Search& search,
             const Indices& usable,
             const bayesian_icp::Vector6d& pose)
{
  const Eigen::Matrix4d T = bayesian_icp::matrixOf(pose);
  if (!T.template cast<Scalar>().allFinite())
    return (false);
  previous_transformation_ = transformation_;
  transformation_ = (T * final_transformation_.template cast<double>().inverse().eval())
                        .template cast<Scalar>();
  final_transformation_ = T.template cast<Scalar>();
  ++nr_iterations_;
  if (update_visualizer_ == nullptr)
    return (true);
  findPairs(search, usable);
  PointCloudSource moved = *input_;
  this->transformCloud(*input_, moved, final_transformation_);
  Indices in_source, in_target;
  for (const auto& pair : *correspondences_) {
    in_source.push_back(pair.index_query);
    in_target.push_back(pair.index_match);
  }
  update_visualizer_(moved, in_source, *target_, in_target);
  return (true);
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    findPairs(const Search& search, const Indices& usable)
{
  const bayesian_icp::Vector6d pose =
      bayesian_icp::poseOf(final_transformation_.template cast<double>());
  Eigen::Matrix3Xd moved;
  bayesian_icp::movePoints(
      pose, bayesian_icp_detail::pointMatrix(*input_, usable), moved);
  *correspondences_ = search.findPairs(pose, {usable.begin(), usable.end()}, moved);
  for (auto& pair : *correspondences_)
    pair.index_query = usable[static_cast<std::size_t>(pair.index_query)];
}

template <typename PointSource, typename PointTarget, typename Scalar>
void
StochasticGradientDescentIterativeClosestPoint<PointSource, PointTarget, Scalar>::
    publishEnd()
{
  using bayesian_icp::DescentEnd;
  auto state = State::CONVERGENCE_CRITERIA_NOT_CONVERGED;
  if (result_.end == DescentEnd::Converged)
    state = State::CONVERGENCE_CRITERIA_TRANSFORM;
  else if (result_.end == DescentEnd::TooFewCorrespondences)
    state = State::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES;
  else if (result_.end == DescentEnd::MaxIterations)
    state = convergence_criteria_->getFailureAfterMaximumIterations()
                ? State::CONVERGENCE_CRITERIA_FAILURE_AFTER_MAX_ITERATIONS
                : State::CONVERGENCE_CRITERIA_ITERATIONS;
  convergence_criteria_->setConvergenceState(state);
  converged_ = state == State::CONVERGENCE_CRITERIA_TRANSFORM ||
               state == State::CONVERGENCE_CRITERIA_ITERATIONS;
  if (result_.end == DescentEnd::TooFewCorrespondences)
    PCL_ERROR("[pcl::%s::computeTransformation] Not enough correspondences found. "
              "Relax your threshold parameters.\n",
              getClassName().c_str());
  else if (result_.end == DescentEnd::Diverged)
    PCL_ERROR("[pcl::%s::computeTransformation] The descent diverged.\n",
              getClassName().c_str());
  else if (result_.end == DescentEnd::InvalidInput) {
    const std::string complaint = getOptions().validate();
    PCL_ERROR("[pcl::%s::computeTransformation] No registration: %s.\n",
              getClassName().c_str(),
              complaint.empty()
                  ? "the initial guess is not a rotation and a translation"
                  : complaint.c_str());
  }
}

} // namespace pcl
