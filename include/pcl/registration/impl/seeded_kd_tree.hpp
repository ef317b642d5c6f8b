/** \file
 * \brief PCL's search tree and its correspondence estimation, answered by this
 * library's tree.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/registration/correspondence_estimation.h>
#include <pcl/registration/impl/bayesian_icp_search.hpp>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
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
      const Tree::Neighbor nearest = builtTree()->nearest(
          point.getVector3fMap(), std::numeric_limits<float>::max());
      // If none is found, FLANN asserts that the point is finite.
      if (nearest.index != Tree::none && !nearest.is_tied) {
        indices.assign(1, static_cast<index_t>(nearest.index));
        squared_distances.assign(1, nearest.squared_distance);
        return (1);
      }
    }
    return (searchFlann(point, k, indices, squared_distances));
  }

  /** FLANN's own answer. */
  int
  searchFlann(const PointT& point,
              unsigned int k,
              Indices& indices,
              std::vector<float>& squared_distances) const
  {
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
    buildOnce(is_flann_built_, [this] {
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
    });
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

/** PCL's correspondence estimation, which asks this library's tree for all pairs at
 * once, by several threads. The search for a point begins at its last answer. Pairs are
 * PCL's to the last bit. Any other tree is asked as PCL does. */
template <typename PointSource, typename PointTarget, typename Scalar>
class SeededEstimation
: public registration::CorrespondenceEstimation<PointSource, PointTarget, Scalar> {
public:
  using Base = registration::CorrespondenceEstimation<PointSource, PointTarget, Scalar>;
  using BasePtr = typename registration::
      CorrespondenceEstimationBase<PointSource, PointTarget, Scalar>::Ptr;

  /** 0: as OpenMP would. No pair depends on it. */
  int num_threads = 0;

  void
  determineCorrespondences(
      Correspondences& correspondences,
      double max_distance = std::numeric_limits<double>::max()) override
  {
    const auto* own = dynamic_cast<const SeededKdTree<PointTarget>*>(tree_.get());
    if (!own) {
      Base::determineCorrespondences(correspondences, max_distance);
      return;
    }
    if (!this->initCompute()) // which gives the target to the tree, if it is a new one
      return;
    const auto tree = own->seeded->get();
    if (!tree) {
      this->deinitCompute();
      Base::determineCorrespondences(correspondences, max_distance);
      return;
    }
    last_answers_.resize(indices_->size(), bayesian_icp::KdTree::none);
    correspondences.resize(indices_->size());
    bayesian_icp::searchInBlocks(
        indices_->size(), num_threads, [&](std::size_t begin, std::size_t end) {
          findPairs(begin, end, *tree, *own->seeded, max_distance, correspondences);
        });
    correspondences.erase(std::remove_if(correspondences.begin(),
                                         correspondences.end(),
                                         [](const Correspondence& pair) {
                                           return (pair.index_match == UNAVAILABLE);
                                         }),
                          correspondences.end());
    this->deinitCompute();
  }

  BasePtr
  clone() const override
  {
    return (BasePtr(new SeededEstimation(*this)));
  }

protected:
  using Base::indices_;
  using Base::input_;
  using Base::tree_;

private:
  /** The pairs of some of the indices; index_match is UNAVAILABLE where there is none.
   */
  void
  findPairs(std::size_t begin,
            std::size_t end,
            const bayesian_icp::KdTree& tree,
            const SeededFlann<PointTarget>& flann,
            double max_distance,
            Correspondences& pairs)
  {
    constexpr float max_float = std::numeric_limits<float>::max();
    const double max_squared_distance = max_distance * max_distance;
    // Rounded up; the exact gate is below.
    const float gate =
        max_squared_distance < max_float
            ? std::nextafter(static_cast<float>(max_squared_distance), max_float)
            : max_float;
    PointTarget query;
    Indices found(1);
    std::vector<float> squared_distance(1);
    // Beams without a return are (0, 0, 0) in some drivers' clouds: each search for
    // such a point would meet all of them in the target.
    Eigen::Vector3f tied_point = Eigen::Vector3f::Constant(max_float);
    Correspondence of_tied;
    for (std::size_t i = begin; i < end; ++i) {
      const index_t index = (*indices_)[i];
      const PointSource& point = (*input_)[static_cast<std::size_t>(index)];
      if (point.getVector3fMap() == tied_point) {
        pairs[i] = of_tied;
        pairs[i].index_query = index;
        continue;
      }
      const auto nearest = tree.nearest(point.getVector3fMap(), gate, last_answers_[i]);
      pairs[i] = Correspondence(index, UNAVAILABLE, 0.f);
      if (nearest.index == bayesian_icp::KdTree::none)
        continue;
      last_answers_[i] = nearest.index;
      if (nearest.squared_distance > max_squared_distance)
        continue;
      found[0] = static_cast<index_t>(nearest.index);
      squared_distance[0] = nearest.squared_distance;
      if (nearest.is_tied) {
        copyPoint(point, query);
        flann.searchFlann(query, 1, found, squared_distance);
        tied_point = point.getVector3fMap();
        of_tied = Correspondence(index, found[0], squared_distance[0]);
      }
      pairs[i] = Correspondence(index, found[0], squared_distance[0]);
    }
  }

  /** One for each of the indices. */
  std::vector<std::uint32_t> last_answers_;
};

} // namespace bayesian_icp_detail
} // namespace pcl
