#include "search/squared_gate.h"

#include <bayesian_icp/tree_search.h>

namespace bayesian_icp {

CorrespondenceSearch::~CorrespondenceSearch() = default;

TreeSearch::TreeSearch(const KdTree& target, double max_distance)
: target_(target)
, max_squared_distance_(squaredGate(max_distance))
{}

void
TreeSearch::find(const Vector6d& /* pose */,
                 const std::vector<std::size_t>& /* source_indices */,
                 const Eigen::Matrix3Xd& moved_points,
                 Correspondences& correspondences) const
{
  correspondences.clear();
  for (Eigen::Index i = 0; i < moved_points.cols(); ++i) {
    const auto neighbor =
        target_.nearest(moved_points.col(i).cast<float>(), max_squared_distance_);
    if (neighbor.index != KdTree::none)
      correspondences.push_back({static_cast<std::size_t>(i),
                                 target_.points().col(neighbor.index).cast<double>()});
  }
}

bool
TreeSearch::isThreadSafe() const
{
  return true;
}

} // namespace bayesian_icp
