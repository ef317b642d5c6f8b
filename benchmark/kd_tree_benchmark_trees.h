/** \file
 * \brief The trees that kd_tree_benchmark compares, behind one interface: made of
 * points, build() again, nearest(query, last neighbour), and nearestK(query, k), which
 * returns the index of the last of them.
 */
#pragma once

#include "benchmark_clouds.h"
#include "search/point_neighbors.h"

#include <bayesian_icp/kd_tree.h>

#include <pcl/kdtree/kdtree_flann.h>

#include <nanoflann.hpp>

#include <cstdint>
#include <limits>
#include <vector>

class FlannTree {
public:
  explicit FlannTree(const Eigen::Matrix3Xf& points) : cloud_(cloudOf(points))
  {
    build();
  }

  void
  build()
  {
    tree_.setInputCloud(cloud_);
  }

  int
  nearest(const Eigen::Vector3f& query, std::uint32_t)
  {
    tree_.nearestKSearch({query.x(), query.y(), query.z()}, 1, index_, distance_);
    return index_[0];
  }

  int
  nearestK(const Eigen::Vector3f& query, int k)
  {
    tree_.nearestKSearch({query.x(), query.y(), query.z()}, k, index_, distance_);
    return index_.back();
  }

private:
  Cloud::Ptr cloud_;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
  pcl::Indices index_ = pcl::Indices(1);
  std::vector<float> distance_ = std::vector<float>(1);
};

/** What nanoflann wants to know about a cloud. */
struct NanoflannCloud {
  const Eigen::Matrix3Xf& points;

  std::size_t
  kdtree_get_point_count() const
  {
    return static_cast<std::size_t>(points.cols());
  }
  float
  kdtree_get_pt(std::size_t index, std::size_t axis) const
  {
    return points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(index));
  }
  template <typename Box>
  bool
  kdtree_get_bbox(Box&) const
  {
    return false;
  }
};

using NanoflannIndex = nanoflann::KDTreeSingleIndexAdaptor<
    nanoflann::L2_Simple_Adaptor<float, NanoflannCloud>,
    NanoflannCloud,
    3,
    std::uint32_t>;

class NanoflannTree {
public:
  explicit NanoflannTree(const Eigen::Matrix3Xf& points, bool is_seeded = false)
  : cloud_{points}
  , tree_(3, cloud_, {10})
  , is_seeded_(is_seeded)
  {
    build();
  }

  void
  build()
  {
    tree_.buildIndex();
  }

  std::uint32_t
  nearest(const Eigen::Vector3f& query, std::uint32_t last_neighbor) const
  {
    std::uint32_t index = 0;
    float squared_distance = 0.0f;
    nanoflann::KNNResultSet<float, std::uint32_t> result(1);
    result.init(&index, &squared_distance); // which is the largest number then
    if (is_seeded_) {
      index = last_neighbor;
      squared_distance = (cloud_.points.col(last_neighbor) - query).squaredNorm();
    }
    tree_.findNeighbors(result, query.data(), {});
    return index;
  }

  std::uint32_t
  nearestK(const Eigen::Vector3f& query, int k)
  {
    const auto count = static_cast<std::size_t>(k);
    indices_.resize(count);
    squared_distances_.resize(count);
    tree_.knnSearch(query.data(), count, indices_.data(), squared_distances_.data());
    return indices_.back();
  }

private:
  NanoflannCloud cloud_;
  NanoflannIndex tree_;
  bool is_seeded_;
  std::vector<std::uint32_t> indices_;
  std::vector<float> squared_distances_;
};

class OwnTree {
public:
  OwnTree(const Eigen::Matrix3Xf& points,
          bool is_seeded,
          bayesian_icp::InstructionSet instruction_set)
  : tree_(points, 0, instruction_set)
  , is_seeded_(is_seeded)
  {}

  std::uint32_t
  nearest(const Eigen::Vector3f& query, std::uint32_t last_neighbor) const
  {
    const std::uint32_t hint = is_seeded_ ? last_neighbor : bayesian_icp::KdTree::none;
    return tree_.nearest(query, std::numeric_limits<float>::infinity(), hint).index;
  }

private:
  bayesian_icp::KdTree tree_;
  bool is_seeded_;
};

class OwnNeighbors {
public:
  explicit OwnNeighbors(const Eigen::Matrix3Xf& points) : neighbors_(points) {}

  std::uint32_t
  nearestK(const Eigen::Vector3f& query, int k)
  {
    neighbors_.find(query, static_cast<std::size_t>(k), list_);
    return list_.indices.back();
  }

private:
  bayesian_icp::PointNeighbors neighbors_;
  bayesian_icp::NeighborList list_;
};
