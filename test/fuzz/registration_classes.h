/** \file
 * \brief Registering an input by the classes, and checking what comes of it.
 */
#pragma once

#include "fuzz_input.h"
#include "registration_input.h"

#include <bayesian_icp/stochastic_gradient_icp.h>
#include <bayesian_icp/summary.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

namespace bayesian_icp::fuzz {

/** \brief End the fuzzer unless the result is as results are, whatever the input was.
 */
void
checkEstimate(const Summary& summary, const PoseMatrix& samples);

void
checkDescent(const RegistrationInput& input, const StochasticGradientIcpResult& result);

/** \brief As registerByClass(), for points with normals and Scalar double. */
void
registerNormalsByClass(const RegistrationInput& input);

/** \brief By SGD-ICP: the function and the class. */
void
registerByDescent(const RegistrationInput& input);

/** \brief Cancels a run that takes too many steps. */
inline ProgressCallback
limitSteps(const RegistrationInput& input)
{
  return [num_left = input.max_num_steps](const Progress&) mutable {
    return --num_left > 0;
  };
}

/** \brief Normals, if PointT has them, are (0, 0, 1). */
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr
pclCloudOf(const Eigen::Matrix3Xd& points)
{
  const typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (const Eigen::Vector3d point : points.colwise()) {
    cloud->emplace_back();
    cloud->back().getVector3fMap() = point.cast<float>();
    if constexpr (pcl::traits::has_normal<PointT>::value)
      cloud->back().normal_z = 1.f;
  }
  return cloud;
}

/** \brief Give the clouds of \p input to \p icp, align, and check what every
 * registration of PCL's has.
 * \return whether align() has called the class: PCL keeps no empty cloud */
template <typename PointT, typename Registration>
bool
align(const RegistrationInput& input, Registration& icp)
{
  icp.setInputSource(pclCloudOf<PointT>(input.source));
  icp.setInputTarget(pclCloudOf<PointT>(input.target));
  icp.setMaxCorrespondenceDistance(input.gate);
  icp.setUseReciprocalCorrespondences(input.is_reciprocal);
  pcl::PointCloud<PointT> output;
  using Scalar = typename Registration::Matrix4::Scalar;
  icp.align(output, matrixOf(input.guess).template cast<Scalar>());
  if (input.source.cols() == 0 || input.target.cols() == 0)
    return false;
  require(output.size() == std::size_t(input.source.cols()), "all points come out");
  require(icp.getFinalTransformation().allFinite(),
          "the final transformation is finite");
  icp.getFitnessScore();
  return true;
}

template <typename PointT, typename Scalar>
void
registerByClass(const RegistrationInput& input)
{
  pcl::BayesianIterativeClosestPoint<PointT, PointT, Scalar> icp;
  icp.setMaximumIterations(input.icp_iterations);
  icp.setUseMeanAsFinalTransformation(input.use_mean);
  icp.setOptions(input.options);
  icp.setProgressCallback(limitSteps(input));
  if (align<PointT>(input, icp))
    checkEstimate(icp.getSummary(), icp.getSamples());
}

} // namespace bayesian_icp::fuzz
