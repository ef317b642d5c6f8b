/** \file
 * \brief The k nearest points of a cloud, for neighbourhoods of one point after the
 * other.
 */
#pragma once

#include "search/kd_tree_build.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief The result of a search, and data that make the next one faster. For one
 * thread and one PointNeighbors. */
class NeighborList {
public:
  /** Nearest first, equally near ones by their index. */
  std::vector<std::uint32_t> indices;
  /** Of the same points [m^2]. */
  std::vector<float> squared_distances;

private:
  friend class PointNeighbors;

  /** What a search has found: at least count points within the radius of the query. */
  struct Ball {
    std::size_t count;
    Eigen::Vector3f query;
    float radius;
  };

  /** The last search for each count. */
  std::vector<Ball> last_balls_;
  /** Squared distance, as its bits, and index: they sort as the points do. */
  std::vector<std::uint64_t> found_, sorted_;
  std::vector<std::uint32_t> buckets_;
};

/** \brief Nearest points of a cloud that does not change, k at a time. */
class PointNeighbors {
public:
  /** \param[in] points 3 x n, finite; must outlive this object */
  explicit PointNeighbors(const Eigen::Matrix3Xf& points);

  /** \brief The \p count nearest points, at least 1, nearest first; fewer if there are
   * fewer. A point is left out if the squared distance to it is too large for a float.
   * \param[in] query finite; the search is faster near the last query with \p list
   * \param[in] count how many
   * \param[in,out] list an empty one, or of an earlier search in this object */
  void
  find(const Eigen::Vector3f& query, std::size_t count, NeighborList& list) const;

  const Eigen::Matrix3Xf&
  points() const
  {
    return points_;
  }

  /** \brief The indices of all points, in an order in which most are near the one
   * before.
   */
  std::vector<std::uint32_t>
  alongTree() const;

private:
  std::size_t
  gather(const Eigen::Vector3f& query,
         std::size_t count,
         float limit,
         std::vector<std::uint64_t>& found) const;

  const Eigen::Matrix3Xf& points_;
  kd_tree::Storage tree_;
  decltype(kd_tree::Searches::nearestK) nearest_k_;
};

} // namespace bayesian_icp
