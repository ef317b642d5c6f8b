/** \file
 * \brief PCL's search tree, answered by this library's one.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/registration/impl/bayesian_icp_search.hpp>
#include <pcl/search/kdtree.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <typeinfo>
#include <utility>
#include <vector>

namespace pcl {
namespace bayesian_icp_detail {

/** Whether points are compared by their coordinates, as they are by default. */
template <typename PointT>
bool
isDefault(const PointRepresentation<PointT>& representation)
{
  return (typeid(representation) == typeid(DefaultPointRepresentation<PointT>));
}

/** PCL's tree of FLANN that asks this library's tree for the nearest point.
 *
 * Squared distances are computed as FLANN's are, so answers are FLANN's to the last bit
 * where one point is the nearest. FLANN itself is asked, and built when it is first
 * asked, where several points are exactly as near, and for more than one point or a
 * radius. It is asked for everything where points are chosen by indices or compared by
 * an own representation. A search that need not be exact (setEpsilon()) is exact. */
template <typename PointT>
class SeededFlann : public KdTreeFLANN<PointT> {
public:
  using Base = KdTreeFLANN<PointT>;
  using CloudConstPtr = typename Base::PointCloudConstPtr;
  using IndicesConstPtr = shared_ptr<const Indices>;
  using Tree = bayesian_icp::KdTree;
  using Base::nearestKSearch;
  using Base::radiusSearch;

  /** To build with, 0: as OpenMP would. No answer depends on it. */
  int num_threads = 1;

  /** Takes a copy of the points, as FLANN does; nothing is built if they are those that
   * it has, to the last bit. */
  void
  setInputCloud(const CloudConstPtr& cloud,
                const IndicesConstPtr& indices = IndicesConstPtr()) override
  {
    const bool is_plain =
        cloud && !indices && isDefault(*this->getPointRepresentation());
    if (is_plain && !(is_plain_ && areSame(*cloud, points()))) {
      points_ = pointMatrix<float>(*cloud);
      tree_.reset();
      is_tree_built_ = is_flann_built_ = false;
    }
    is_plain_ = is_plain && points().array().isFinite().colwise().all().any();
    if (is_plain_) {
      this->input_ = cloud;
      this->indices_.reset();
      this->epsilon_ = 0.0f; // as FLANN does
    }
    else {
      is_flann_built_ = true;
      Base::setInputCloud(cloud, indices);
    }
  }

  int
  nearestKSearch(const PointT& point,
                 unsigned int k,
                 Indices& indices,
                 std::vector<float>& squared_distances) const override
  {
    if (k == 1 && is_plain_) {
      const Tree::Neighbor nearest = nearestTo(point);
      // If none is found, FLANN asserts that the point is finite.
      if (nearest.index != Tree::none && !nearest.is_tied) {
        indices.assign(1, static_cast<index_t>(nearest.index));
        squared_distances.assign(1, nearest.squared_distance);
        return (1);
      }
    }
    buildFlann();
    return (Base::nearestKSearch(point, k, indices, squared_distances));
  }

  int
  radiusSearch(const PointT& point,
               double radius,
               Indices& indices,
               std::vector<float>& squared_distances,
               unsigned int max_nn = 0) const override
  {
    buildFlann();
    return (Base::radiusSearch(point, radius, indices, squared_distances, max_nn));
  }

  /** The tree that is asked, built when it is first asked for; null where FLANN is
   * asked for everything. */
  std::shared_ptr<const Tree>
  get() const
  {
    return (is_plain_ ? builtTree() : nullptr);
  }

  /** From now on the search for a point begins at the last answer for what was at the
   * same address. That never changes an answer.
   * \param[in] num_points how many there are, one after the other; 0: no more */
  void
  beginAtLastAnswers(std::size_t num_points)
  {
    last_answers_ = std::vector<std::atomic<std::uint32_t>>(num_points);
  }

private:
  /** To the last bit: points that are not finite are not equal to themselves. */
  static bool
  areSame(const PointCloud<PointT>& cloud, const Eigen::Matrix3Xf& points)
  {
    bool are_same = cloud.size() == static_cast<std::size_t>(points.cols());
    for (std::size_t i = 0; are_same && i < cloud.size(); ++i)
      are_same = std::memcmp(cloud[i].data, points.data() + 3 * i, 12) == 0;
    return (are_same);
  }

  Tree::Neighbor
  nearestTo(const PointT& point) const
  {
    constexpr float no_gate = std::numeric_limits<float>::max();
    const Tree& tree = *builtTree();
    if (last_answers_.empty())
      return (tree.nearest(point.getVector3fMap(), no_gate));
    // Each point of an array has a slot of its own.
    const std::size_t slot = reinterpret_cast<std::uintptr_t>(&point) / sizeof(PointT);
    auto& last_answer = last_answers_[slot % last_answers_.size()];
    const auto nearest = tree.nearest(
        point.getVector3fMap(), no_gate, last_answer.load(std::memory_order_relaxed));
    last_answer.store(nearest.index, std::memory_order_relaxed);
    return (nearest);
  }

  const Eigen::Matrix3Xf&
  points() const
  {
    return (tree_ ? tree_->points() : points_);
  }

  const std::shared_ptr<const Tree>&
  builtTree() const
  {
    buildOnce(is_tree_built_, [this] {
      tree_ = std::make_shared<const Tree>(std::move(points_), num_threads);
    });
    return (tree_);
  }

  /** Over the points as they were given, if that has not been done. */
  void
  buildFlann() const
  {
    buildOnce(is_flann_built_, [this] { buildFlannAnew(); });
  }

  void
  buildFlannAnew() const
  {
    const auto copy = pcl::make_shared<PointCloud<PointT>>();
    copy->resize(static_cast<std::size_t>(points().cols()));
    for (std::size_t i = 0; i < copy->size(); ++i)
      (*copy)[i].getVector3fMap() = points().col(static_cast<Eigen::Index>(i));
    auto& self = const_cast<SeededFlann&>(*this);
    const CloudConstPtr cloud = this->input_;
    const float epsilon = this->epsilon_;
    self.Base::setInputCloud(copy);
    self.input_ = cloud;
    self.epsilon_ = epsilon;
  }

  /** Builds unless that is done; other threads that ask wait meanwhile. */
  template <typename Build>
  void
  buildOnce(std::atomic<bool>& is_built, const Build& build) const
  {
    if (is_built.load(std::memory_order_acquire))
      return;
    const std::lock_guard<std::mutex> lock(building_);
    if (is_built.load(std::memory_order_relaxed))
      return;
    build();
    is_built.store(true, std::memory_order_release);
  }

  /** Whether our tree can answer. */
  bool is_plain_ = false;
  /** Until they are in the tree. */
  mutable Eigen::Matrix3Xf points_;
  mutable std::shared_ptr<const Tree> tree_;
  mutable std::atomic<bool> is_tree_built_{false};
  mutable std::vector<std::atomic<std::uint32_t>> last_answers_;
  mutable std::mutex building_;
  /** Without a cloud there is nothing to build. */
  mutable std::atomic<bool> is_flann_built_{true};
};

/** The search tree of this library's registrations. A tree that a user installs in its
 * place is used as PCL would. */
template <typename PointT>
struct SeededKdTree : search::KdTree<PointT> {
  SeededKdTree() { this->tree_ = seeded; }

  const shared_ptr<SeededFlann<PointT>> seeded =
      pcl::make_shared<SeededFlann<PointT>>();
};

} // namespace bayesian_icp_detail
} // namespace pcl
