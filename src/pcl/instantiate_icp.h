/** \file
 * \brief Internal: explicit instantiations of both classes and their base.
 */
#pragma once

#define PCL_REGISTRATION_BAYESIAN_ICP_CPP_
#define PCL_REGISTRATION_CHECKED_ICP_CPP_
#define PCL_REGISTRATION_STOCHASTIC_GRADIENT_ICP_CPP_
#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/stochastic_gradient_icp.h>
#include <pcl/point_types.h>

#define PCL_BAYESIAN_ICP_INSTANTIATE(PointT, Scalar)                                   \
  template class BAYESIAN_ICP_EXPORT                                                   \
      pcl::bayesian_icp_detail::CheckedIterativeClosestPoint<PointT, PointT, Scalar>;  \
  template class BAYESIAN_ICP_EXPORT                                                   \
      pcl::BayesianIterativeClosestPoint<PointT, PointT, Scalar>;                      \
  template class BAYESIAN_ICP_EXPORT                                                   \
      pcl::StochasticGradientDescentIterativeClosestPoint<PointT, PointT, Scalar>;
