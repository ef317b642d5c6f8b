#include "paper/matched_batch.h"

#include <algorithm>
#include <tuple>
#include <vector>

namespace bayesian_icp {

MatchedBatch::MatchedBatch(const Eigen::Matrix3Xd& source_points,
                           const CorrespondenceSearch& search,
                           const MiniBatches& mini_batches)
: source_points_(source_points)
, search_(search)
, mini_batches_(mini_batches)
{}

void
MatchedBatch::draw(const Vector6d& pose, Random& random)
{
  pose_ = pose;
  const auto& batch = mini_batches_.next(random);
  points_.resize(3, static_cast<Eigen::Index>(batch.size()));
  for (std::size_t i = 0; i < batch.size(); ++i)
    points_.col(static_cast<Eigen::Index>(i)) =
        source_points_.col(static_cast<Eigen::Index>(batch[i]));
  movePoints(pose, points_, moved_points_);
  search_.find(pose, batch, moved_points_, correspondences_);
}

void
MatchedBatch::makeOneToOne()
{
  // Pairs of one target point become neighbours, the one to be kept first.
  std::vector<std::size_t> order(correspondences_.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  const auto key = [this](std::size_t i) {
    const auto& pair = correspondences_[i];
    const auto column = static_cast<Eigen::Index>(pair.source_index);
    return std::make_tuple(
        pair.target_point.x(),
        pair.target_point.y(),
        pair.target_point.z(),
        (moved_points_.col(column) - pair.target_point).squaredNorm(),
        i);
  };
  std::sort(order.begin(), order.end(), [&key](std::size_t a, std::size_t b) {
    return key(a) < key(b);
  });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order)
    if (kept.empty() ||
        correspondences_[i].target_point != correspondences_[kept.back()].target_point)
      kept.push_back(i);
  std::sort(kept.begin(), kept.end());
  for (std::size_t i = 0; i < kept.size(); ++i)
    correspondences_[i] = correspondences_[kept[i]];
  correspondences_.resize(kept.size());
}

} // namespace bayesian_icp
