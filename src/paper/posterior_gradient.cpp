#include "paper/posterior_gradient.h"

namespace bayesian_icp {

PosteriorGradient::PosteriorGradient(const Eigen::Matrix3Xd& source_points,
                                     const CorrespondenceSearch& search,
                                     const Prior& prior,
                                     double weight,
                                     const MiniBatches& mini_batches)
: prior_(prior)
, weight_(weight)
, batch_(source_points, search, mini_batches)
{}

EnergyGradient
PosteriorGradient::operator()(const Vector6d& pose, Random& random)
{
  batch_.draw(pose, random);
  EnergyGradient gradient;
  gradient.mini_batch_mean = batch_.meanGradient();
  gradient.energy = weight_ * gradient.mini_batch_mean + prior_.energyGradient(pose);
  return gradient;
}

} // namespace bayesian_icp
