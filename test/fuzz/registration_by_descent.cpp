#include "registration_classes.h"

#include <bayesian_icp/tree_search.h>

#include <pcl/registration/stochastic_gradient_icp.h>

namespace bayesian_icp::fuzz {

namespace {

StochasticGradientIcpProgress
limitIterations(const RegistrationInput& input)
{
  return [&input](int iteration, const Vector6d&) {
    return iteration < input.max_num_steps;
  };
}

} // namespace

void
registerByDescent(const RegistrationInput& input)
{
  const KdTree target(input.target.cast<float>(), 1);
  checkDescent(input,
               stochasticGradientIcp(input.source,
                                     TreeSearch(target, input.gate),
                                     input.guess,
                                     input.descent,
                                     limitIterations(input)));

  pcl::StochasticGradientDescentIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setOptions(input.descent);
  icp.setProgressCallback(limitIterations(input));
  if (align<pcl::PointXYZ>(input, icp))
    checkDescent(input, icp.getResult());
}

} // namespace bayesian_icp::fuzz
