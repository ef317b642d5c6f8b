/** \file
 * \brief What the chains of preset `exact` remember of the nearest neighbours of their
 * points.
 */
#pragma once

#include "search/kd_tree_kernels.h"

#include <bayesian_icp/kd_tree.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Nearest neighbours of points that move a little from query to query.
 *
 * For each point it remembers a ball in which the nearest neighbour is known: it is
 * always the same one, or one of 16, or there is none within the gate. Queries in the
 * ball are settled without the tree. Answers are those of KdTree::nearest() to the last
 * bit: the ball leaves room for the rounding of distances. Where queries leave the
 * balls, new ones are made, but only as often as they are worth their time. */
class NeighborCache {
public:
  /** \param[in] num_points how many points move */
  explicit NeighborCache(std::size_t num_points = 0) : places_(num_points) {}

  /** \brief tree.nearest(query, max_squared_distance).index.
   * \param[in] tree always the same one, like the gate
   * \param[in] point number of the point
   * \param[in] query where it is now */
  std::uint32_t
  nearest(const KdTree& tree,
          float max_squared_distance,
          std::size_t point,
          const Eigen::Vector3f& query);

private:
  /** A ball, and what is known in it. It is empty at first. */
  struct Place {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    /** Of the ball in which the neighbour is in the leaf, or there is none [m^2]. */
    float squared_radius = 0.f;
    /** Of the ball in which the answer is \p sole_answer [m^2]. */
    float squared_sole_radius = 0.f;
    std::uint32_t sole_answer = KdTree::none;
    /** Where a search begins. */
    std::uint32_t hint = KdTree::none;
    /** Sum of the queries that were searched since the ball was made, and how many. */
    Eigen::Vector3f sum_of_misses = Eigen::Vector3f::Zero();
    std::uint16_t num_misses = 0;
    /** How many were settled in the ball, as far as that matters. */
    std::uint16_t num_hits = 0;
    /** Misses until the next ball. */
    std::uint16_t patience = 32;
  };

  std::uint32_t
  search(const KdTree& tree,
         float max_squared_distance,
         std::size_t point,
         const Eigen::Vector3f& query);

  void
  enclose(const KdTree& tree,
          float max_squared_distance,
          std::size_t point,
          const Eigen::Vector3f& centre);

  std::vector<Place> places_;
  /** One for each point, as soon as one of them needs it. */
  std::vector<kd_tree::Leaf> leaves_;
};

} // namespace bayesian_icp
