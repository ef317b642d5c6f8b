#include "calibrated/cloud_parts.h"

#include <bayesian_icp/prepared_cloud.h>

#include <utility>

namespace bayesian_icp {

PreparedCloud::PreparedCloud(Eigen::Matrix3Xd points)
: parts_(std::make_shared<CloudParts>(std::move(points)))
{}

const Eigen::Matrix3Xd&
PreparedCloud::points() const
{
  return parts_->points;
}

void
PreparedCloud::prepare(Preset preset, int num_threads) const
{
  if (preset == Preset::Calibrated)
    parts_->surfaceFor(*parts_, num_threads);
  else
    parts_->tree(num_threads);
}

} // namespace bayesian_icp
