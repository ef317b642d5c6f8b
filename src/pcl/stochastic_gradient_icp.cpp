// Explicit instantiations of the SGD-ICP class; its base's are with those of Bayesian
// ICP.
#define PCL_REGISTRATION_STOCHASTIC_GRADIENT_ICP_CPP_
#include <pcl/registration/stochastic_gradient_icp.h>
#include <pcl/point_types.h>

#define PCL_BAYESIAN_ICP_INSTANTIATE(PointT, Scalar)                                   \
  template class BAYESIAN_ICP_EXPORT                                                   \
      pcl::StochasticGradientDescentIterativeClosestPoint<PointT, PointT, Scalar>;
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_INSTANTIATE, float)
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_INSTANTIATE, double)
