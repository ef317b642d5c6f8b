#include "search/neighbor_cache.h"

#include "search/kd_tree_build.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Vector3f;
using kd_tree::leaf_size;

namespace {

constexpr float no_gate = std::numeric_limits<float>::max();
/** Rivals that are sought. A leaf has room for 15, and repeated points take none. */
constexpr std::size_t num_rivals = 24;
/** A distance differs from its true value by less than 4e-7 of itself. The threshold is
 * 2e-5 above the squared distance, and radii are 2e-4 below what follows from it: then
 * no point outside of the leaf can be as near as the nearest one in it, or seem so. */
constexpr float threshold_factor = 1.f + 2e-5f;
constexpr float radius_factor = 1.f - 2e-4f;
/** Radii outside of these limits [m] are not worth the care that their squares need. */
constexpr float min_radius = 1e-12f, max_radius = 1e6f;
/** By how much a distance has to differ from the gate, as a share of the larger one. */
constexpr float gate_margin = 1e-5f;
/** The next ball waits for twice as many misses as the last one, or for far more if
 * that one did not settle this many queries for each miss; but for no more than the
 * largest patience. */
constexpr int worthwhile_hits = 2, more_patience = 2, far_more_patience = 8;
constexpr int max_patience = 1024;

/** The square of a radius a little below \p reach. */
float
squaredRadius(float reach)
{
  const float radius = radius_factor * std::min(reach, max_radius);
  return radius > min_radius ? radius * radius : 0.f;
}

/** A leaf of \p size columns of \p points; \p members are sorted. */
kd_tree::Leaf
leafOf(const Eigen::Matrix3Xf& points, const std::uint32_t* members, std::size_t size)
{
  kd_tree::Leaf leaf;
  for (std::size_t i = 0; i < leaf_size; ++i) {
    const bool is_member = i < size;
    leaf.index[i] = is_member ? members[i] : kd_tree::no_point;
    for (int axis = 0; axis < 3; ++axis)
      leaf.coordinates[axis][i] =
          is_member ? points(axis, members[i]) : std::numeric_limits<float>::infinity();
  }
  return leaf;
}

/** A search for rivals, with room for their keys. */
struct RivalSearch {
  std::array<std::uint64_t, 2 * (num_rivals + leaf_size)> keys;
  kd_tree::Rivals found;

  RivalSearch(const Vector3f& nearest, float squared_distance)
  {
    found.count = num_rivals;
    found.limit = no_gate;
    found.first = found.end = keys.data();
    std::copy_n(nearest.data(), 3, found.nearest);
    found.threshold = threshold_factor * squared_distance;
  }

  /** Those that were looked for, or all there are. */
  void
  sort()
  {
    if (found.end > found.first + num_rivals)
      kd_tree::dropOthers(found);
    std::sort(found.first, found.end);
  }
};

} // namespace

std::uint32_t
NeighborCache::nearest(const KdTree& tree,
                       float max_squared_distance,
                       std::size_t point,
                       const Vector3f& query)
{
  Place& place = places_[point];
  const float moved = (query - place.centre).squaredNorm();
  const bool has_sole_answer = moved < place.squared_sole_radius;
  if (!has_sole_answer && !(moved < place.squared_radius))
    return search(tree, max_squared_distance, point, query);
  if (place.num_hits < worthwhile_hits * max_patience)
    ++place.num_hits;
  if (has_sole_answer)
    return place.sole_answer;
  kd_tree::Best best{std::min(max_squared_distance, no_gate), kd_tree::no_point, false};
  tree.tree_->searches.nearestInLeaf(leaves_[point], query.data(), best);
  return best.index;
}

std::uint32_t
NeighborCache::search(const KdTree& tree,
                      float max_squared_distance,
                      std::size_t point,
                      const Vector3f& query)
{
  Place& place = places_[point];
  const auto found = tree.nearest(query, max_squared_distance, place.hint);
  if (found.index != KdTree::none)
    place.hint = found.index;
  place.sum_of_misses += query;
  if (++place.num_misses == place.patience)
    enclose(tree,
            max_squared_distance,
            point,
            place.sum_of_misses / static_cast<float>(place.num_misses));
  return found.index;
}

void
NeighborCache::enclose(const KdTree& tree,
                       float max_squared_distance,
                       std::size_t point,
                       const Vector3f& centre)
{
  Place& place = places_[point];
  place.sum_of_misses.setZero();
  const bool had_ball = place.squared_sole_radius > 0.f || place.squared_radius > 0.f;
  const bool was_worthwhile =
      !had_ball || place.num_hits >= worthwhile_hits * place.num_misses;
  place.num_misses = place.num_hits = 0;
  place.patience = static_cast<std::uint16_t>(
      std::min(place.patience * (was_worthwhile ? more_patience : far_more_patience),
               max_patience));
  place.squared_radius = place.squared_sole_radius = 0.f;
  const auto nearest = tree.nearest(centre, no_gate, place.hint);
  if (nearest.index == KdTree::none)
    return;
  place.centre = centre;
  const float gate = std::sqrt(std::min(max_squared_distance, no_gate));
  const float distance = std::sqrt(nearest.squared_distance);
  const bool is_within = distance <= gate;
  place.sole_answer = is_within ? nearest.index : KdTree::none;
  place.squared_sole_radius =
      squaredRadius(std::abs(gate - distance) - gate_margin * std::max(gate, distance));
  if (!is_within)
    return;

  const Eigen::Matrix3Xf& points = tree.points();
  RivalSearch rivals(points.col(nearest.index), nearest.squared_distance);
  tree.tree_->searches.rivals(tree.tree_->view, centre.data(), rivals.found);
  rivals.sort();
  std::array<std::uint32_t, leaf_size> members;
  std::size_t size = 0;
  members[size++] = nearest.index;
  float squared_reach = rivals.found.limit;
  for (const std::uint64_t* key = rivals.found.first; key != rivals.found.end; ++key) {
    const auto index = static_cast<std::uint32_t>(*key);
    if (points.col(index) == points.col(members[size - 1])) // repeated
      continue;
    squared_reach = kd_tree::squaredDistanceOf(*key);
    if (size == 1)
      place.squared_sole_radius =
          std::min(place.squared_sole_radius, squaredRadius(std::sqrt(squared_reach)));
    if (size == leaf_size)
      break;
    members[size++] = index;
  }
  place.squared_radius = squaredRadius(std::sqrt(squared_reach));

  std::sort(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(size));
  leaves_.resize(places_.size());
  leaves_[point] = leafOf(points, members.data(), size);
}

} // namespace bayesian_icp
