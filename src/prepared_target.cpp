#include "target_parts.h"

#include <bayesian_icp/prepared_target.h>

#include <utility>

namespace bayesian_icp {

PreparedTarget::PreparedTarget(Eigen::Matrix3Xd points)
: parts_(std::make_shared<TargetParts>(std::move(points)))
{}

const Eigen::Matrix3Xd&
PreparedTarget::points() const
{
  return parts_->points;
}

void
PreparedTarget::prepare(Preset preset, int num_threads) const
{
  if (preset == Preset::Calibrated)
    parts_->surface(num_threads);
  else
    parts_->tree(num_threads);
}

} // namespace bayesian_icp
