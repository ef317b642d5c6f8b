#include "options/enumerator_names.h"

#include <bayesian_icp/prior.h>

#include <cmath>

namespace bayesian_icp {

const char*
toString(PriorFrame frame)
{
  return nameOf(frame, {"origin", "source-centroid", "automatic"});
}

Prior::Prior(const Vector6d& mean,
             const Vector6d& variance,
             const Eigen::Vector3d& reference_point)
: mean_(mean)
, variance_(variance)
, reference_point_(reference_point)
, mean_reference_point_(rotationOf(mean) * reference_point + mean.head<3>())
{}

Vector6d
Prior::deviation(const Vector6d& pose) const
{
  Vector6d deviation = pose - mean_;
  deviation.head<3>() =
      rotationOf(pose) * reference_point_ + pose.head<3>() - mean_reference_point_;
  return deviation;
}

double
Prior::energy(const Vector6d& pose) const
{
  const Vector6d d = deviation(pose);
  double energy = 0.0;
  for (int k = 0; k < 3; ++k)
    energy += 0.5 * d[k] * d[k] / variance_[k];
  for (int k = 3; k < 6; ++k)
    energy += (1.0 - std::cos(d[k])) / variance_[k];
  return energy;
}

Vector6d
Prior::energyGradient(const Vector6d& pose) const
{
  const Vector6d d = deviation(pose);
  Vector6d gradient;
  gradient.head<3>() = d.head<3>().cwiseQuotient(variance_.head<3>()); // eq. (6)
  const auto dR = rotationDerivativesOf(pose);
  for (int k = 3; k < 6; ++k)
    gradient[k] =
        std::sin(d[k]) / variance_[k] + // eq. (7)
        gradient.head<3>().dot(dR[static_cast<std::size_t>(k - 3)] * reference_point_);
  return gradient;
}

} // namespace bayesian_icp
