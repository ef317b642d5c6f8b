#include "search/point_neighbors.h"

#include "search/bucket_sort.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Vector3f;
using kd_tree::leaf_size;
using kd_tree::squaredDistanceOf;

namespace {

/** Above any squared distance to a neighbour; below that to a place without a point, or
 * with one so far away that a float cannot hold it. */
constexpr float no_limit = std::numeric_limits<float>::max();

/** Radius of the ball that is searched first, in that of the last one. */
constexpr float usual_growth = 1.15f;

/** Points of a surface are spread evenly over the squared distance. */
void
sortByDistance(const std::vector<std::uint64_t>& keys,
               std::vector<std::uint64_t>& sorted,
               std::vector<std::uint32_t>& buckets)
{
  float furthest = 0.f;
  for (const auto key : keys)
    furthest = std::max(furthest, squaredDistanceOf(key));
  const float scale = 1.f / furthest;
  const bool is_scaled = std::isfinite(scale);
  const auto placeOf = [&](std::uint64_t key) {
    return is_scaled ? std::min(squaredDistanceOf(key) * scale, 1.f) : 0.f;
  };
  sortInBuckets(keys, placeOf, sorted, buckets);
}

} // namespace

void
kd_tree::dropOthers(NearestK& found)
{
  std::uint64_t* const last = found.first + found.count - 1;
  std::nth_element(found.first, last, found.end);
  found.end = last + 1;
  found.limit = squaredDistanceOf(*last);
}

PointNeighbors::PointNeighbors(const Eigen::Matrix3Xf& points)
: points_(points)
, tree_(kd_tree::build(points.data(),
                       static_cast<std::size_t>(points.cols()),
                       1,
                       kd_tree::RepeatedPoints::Kept))
, nearest_k_(kd_tree::searchesOf(supportedInstructionSets().back()).nearestK)
{}

std::vector<std::uint32_t>
PointNeighbors::alongTree() const
{
  std::vector<std::uint32_t> indices;
  indices.reserve(tree_.num_points);
  for (const kd_tree::Leaf& leaf : tree_.leaves)
    for (const std::uint32_t index : leaf.index)
      if (index != kd_tree::no_point)
        indices.push_back(index);
  return indices;
}

/** All points within the square root of \p limit, or the nearest ones of them, at least
 * \p count. */
std::size_t
PointNeighbors::gather(const Vector3f& query,
                       std::size_t count,
                       float limit,
                       std::vector<std::uint64_t>& found) const
{
  found.resize(2 * (count + leaf_size));
  kd_tree::NearestK nearest{count, limit, found.data(), found.data()};
  nearest_k_(tree_.view(), query.data(), nearest);
  found.resize(static_cast<std::size_t>(nearest.end - nearest.first));
  return found.size();
}

void
PointNeighbors::find(const Vector3f& query, std::size_t count, NeighborList& list) const
{
  count = std::min(count, tree_.num_points);
  auto& balls = list.last_balls_;
  auto ball = std::find_if(
      balls.begin(), balls.end(), [&](const auto& b) { return b.count == count; });
  if (ball == balls.end())
    ball = balls.insert(balls.end(), {count, query, std::sqrt(no_limit)});
  // A ball a little larger than the last one mostly has enough points. This one has the
  // points of the last ball, too; a little more for rounding.
  const float sure_radius = 1.0001f * (ball->radius + (query - ball->query).norm());
  const float radius = std::min(usual_growth * ball->radius, sure_radius);
  for (const float limit : {radius * radius, sure_radius * sure_radius, no_limit})
    if (gather(query, count, std::min(limit, no_limit), list.found_) >= count)
      break;
  count = std::min(count, list.found_.size());
  sortByDistance(list.found_, list.sorted_, list.buckets_);
  list.indices.resize(count);
  list.squared_distances.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    list.indices[i] = static_cast<std::uint32_t>(list.sorted_[i]);
    list.squared_distances[i] = squaredDistanceOf(list.sorted_[i]);
  }
  if (count > 0) {
    ball->query = query;
    ball->radius = std::sqrt(list.squared_distances.back());
  }
}

} // namespace bayesian_icp
