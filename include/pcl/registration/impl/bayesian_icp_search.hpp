/** \file
 * \brief PCL's correspondence estimation as a bayesian_icp::CorrespondenceSearch: the
 * default one through its search tree, any other one as a black box.
 */
#pragma once

#include <bayesian_icp/correspondence.h>

#include <pcl/common/io.h>
#include <pcl/registration/correspondence_estimation.h>
#include <pcl/registration/correspondence_rejection.h>
#include <pcl/search/kdtree.h>
#include <pcl/conversions.h>

#include <functional>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

namespace pcl {
namespace bayesian_icp_detail {

/** Largest coordinate of a query [m]. Beyond it a squared distance overflows a float:
 * PCL's trees then leave the answer as it was, and assert that the query is finite. */
constexpr double max_coordinate = 1e18;

/** Whether coordinates are finite and within max_coordinate. */
template <typename Derived>
bool
canBeQueried(const Eigen::MatrixBase<Derived>& coordinates)
{
  return ((coordinates.template cast<double>().array().abs() < max_coordinate).all());
}

/** The coordinates of a cloud, 3 x n [m]. */
template <typename Coordinate = double, typename PointT>
Eigen::Matrix<Coordinate, 3, Eigen::Dynamic>
pointMatrix(const PointCloud<PointT>& cloud)
{
  Eigen::Matrix<Coordinate, 3, Eigen::Dynamic> points(
      3, static_cast<Eigen::Index>(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) =
        cloud[i].getVector3fMap().template cast<Coordinate>();
  return (points);
}

/** The coordinates of the points of \p indices, 3 x n [m]. */
template <typename PointT>
Eigen::Matrix3Xd
pointMatrix(const PointCloud<PointT>& cloud, const Indices& indices)
{
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(indices.size()));
  Eigen::Index column = 0;
  for (const auto index : indices)
    points.col(column++) = cloud[index].getVector3fMap().template cast<double>();
  return (points);
}

/** The source indices that a correspondence estimation was given. Null if it was given
 * none: PCL makes a list of all points of the input then. */
template <typename Estimation>
IndicesPtr
givenSourceIndices(Estimation& estimation)
{
  struct Opened : Estimation {
    using Estimation::fake_indices_;
  };
  const bool are_given = !(estimation.*(&Opened::fake_indices_));
  return (are_given ? estimation.getIndicesSource() : IndicesPtr());
}

/** Gives a correspondence estimation other source indices for the lifetime of this
 * object; null means all points of its input. */
template <typename Estimation>
class SourceIndices {
public:
  SourceIndices(Estimation& estimation, const IndicesPtr& indices)
  : estimation_(estimation)
  , original_(givenSourceIndices(estimation))
  {
    estimation_.setIndicesSource(indices);
  }
  ~SourceIndices() { estimation_.setIndicesSource(original_); }
  SourceIndices(const SourceIndices&) = delete;
  SourceIndices&
  operator=(const SourceIndices&) = delete;

private:
  Estimation& estimation_;
  IndicesPtr original_;
};

/** Nearest neighbour in a PCL search tree; the buffers spare PCL's an allocation. */
template <typename PointT>
class NearestNeighbor {
public:
  explicit NearestNeighbor(const search::KdTree<PointT>& tree) : tree_(tree) {}

  /** Index of the point nearest to \p position, or -1 if none is within
   * \p max_squared_distance [m^2]. */
  index_t
  find(const Eigen::Vector3d& position, double max_squared_distance)
  {
    if (!canBeQueried(position))
      return (-1);
    query_.getVector3fMap() = position.template cast<float>();
    squared_distance_[0] = std::numeric_limits<float>::infinity();
    if (tree_.nearestKSearch(query_, 1, index_, squared_distance_) < 1 ||
        squared_distance_[0] > max_squared_distance)
      return (-1);
    return (index_[0]);
  }

  /** Squared distance of what find() has found [m^2]. */
  float
  squaredDistance() const
  {
    return (squared_distance_[0]);
  }

private:
  const search::KdTree<PointT>& tree_;
  PointT query_;
  Indices index_ = Indices(1);
  std::vector<float> squared_distance_ = std::vector<float>(1);
};

/** A search that also knows which points of the clouds it is asked about, and which
 * ones its answers are. */
template <typename PointTarget>
class PairSearch : public bayesian_icp::CorrespondenceSearch {
public:
  using TargetConstPtr = typename PointCloud<PointTarget>::ConstPtr;

  /** \param[in] usable indices in the source cloud of the points that find() counts */
  PairSearch(const IndicesConstPtr& usable, const TargetConstPtr& target)
  : usable_(usable)
  , target_(target)
  {}

  void
  find(const bayesian_icp::Vector6d& pose,
       const std::vector<std::size_t>& source_indices,
       const Eigen::Matrix3Xd& moved_points,
       bayesian_icp::Correspondences& correspondences) const override
  {
    std::vector<std::size_t> in_cloud;
    in_cloud.reserve(source_indices.size());
    for (const std::size_t index : source_indices)
      in_cloud.push_back(static_cast<std::size_t>((*usable_)[index]));
    correspondences.clear();
    for (const auto& pair : findPairs(pose, in_cloud, moved_points))
      if (pair.index_match >= 0)
        correspondences.push_back({static_cast<std::size_t>(pair.index_query),
                                   targetPoint(pair.index_match)});
  }

  /** As find(), as PCL's pairs: index_query counts columns, distance is squared [m^2].
   * \param[in] source_indices count points of the source cloud, usable or not */
  virtual Correspondences
  findPairs(const bayesian_icp::Vector6d& pose,
            const std::vector<std::size_t>& source_indices,
            const Eigen::Matrix3Xd& moved_points) const = 0;

protected:
  Eigen::Vector3d
  targetPoint(index_t index) const
  {
    return ((*target_)[index].getVector3fMap().template cast<double>());
  }

private:
  IndicesConstPtr usable_;
  TargetConstPtr target_;
};

/** What registration::CorrespondenceEstimation would find, from several threads:
 * queries to a tree that is built are const, the estimation object is not. */
template <typename PointSource, typename PointTarget>
class KdTreeSearch : public PairSearch<PointTarget> {
public:
  using TargetTreeConstPtr = typename search::KdTree<PointTarget>::ConstPtr;
  using SourceConstPtr = typename PointCloud<PointSource>::ConstPtr;
  using TargetConstPtr = typename PointCloud<PointTarget>::ConstPtr;

  /** \param[in] reciprocal_source the source cloud if correspondences have to be
   *            reciprocal, else null */
  KdTreeSearch(const TargetTreeConstPtr& target_tree,
               const TargetConstPtr& target,
               double max_distance,
               const IndicesConstPtr& usable,
               const SourceConstPtr& reciprocal_source)
  : PairSearch<PointTarget>(usable, target)
  , target_tree_(target_tree)
  , max_squared_distance_(max_distance * max_distance)
  {
    if (reciprocal_source) {
      source_tree_.reset(new search::KdTree<PointSource>);
      source_tree_->setInputCloud(reciprocal_source, usable);
    }
  }

  Correspondences
  findPairs(const bayesian_icp::Vector6d& pose,
            const std::vector<std::size_t>& source_indices,
            const Eigen::Matrix3Xd& moved_points) const override
  {
    Correspondences pairs;
    NearestNeighbor<PointTarget> nearest_target(*target_tree_);
    for (Eigen::Index i = 0; i < moved_points.cols(); ++i) {
      const index_t match =
          nearest_target.find(moved_points.col(i), max_squared_distance_);
      if (match >= 0 &&
          (!source_tree_ || isReciprocal(pose,
                                         this->targetPoint(match),
                                         source_indices[static_cast<std::size_t>(i)])))
        pairs.emplace_back(
            static_cast<index_t>(i), match, nearest_target.squaredDistance());
    }
    return (pairs);
  }

  bool
  isThreadSafe() const override
  {
    return (true);
  }

private:
  /** Whether the source point nearest to \p target_point is \p source_index. Sought in
   * the source frame, where the tree need not be built again for every pose. */
  bool
  isReciprocal(const bayesian_icp::Vector6d& pose,
               const Eigen::Vector3d& target_point,
               std::size_t source_index) const
  {
    const Eigen::Vector3d in_source_frame =
        bayesian_icp::rotationOf(pose).transpose() * (target_point - pose.head<3>());
    return (NearestNeighbor<PointSource>(*source_tree_)
                .find(in_source_frame, max_squared_distance_) ==
            static_cast<index_t>(source_index));
  }

  TargetTreeConstPtr target_tree_;
  double max_squared_distance_;
  typename search::KdTree<PointSource>::Ptr source_tree_;
};

/** Whatever correspondence estimation and rejectors the user has installed, applied to
 * each mini-batch in the order in which pcl::IterativeClosestPoint applies them. */
template <typename PointSource, typename PointTarget, typename Scalar>
class PluginSearch : public PairSearch<PointTarget> {
public:
  using Source = PointCloud<PointSource>;
  using SourceConstPtr = typename Source::ConstPtr;
  using TargetConstPtr = typename PointCloud<PointTarget>::ConstPtr;
  using Matrix4 = Eigen::Matrix<Scalar, 4, 4>;
  using Estimation =
      registration::CorrespondenceEstimationBase<PointSource, PointTarget, Scalar>;

  struct Plugins {
    /** Set if only rejectors are the user's own: PCL's estimation, of which a
     * mini-batch would see no more than itself where correspondences have to be
     * reciprocal. */
    std::shared_ptr<const KdTreeSearch<PointSource, PointTarget>> default_search;
    typename Estimation::Ptr estimation;
    std::vector<registration::CorrespondenceRejector::Ptr> rejectors;
    double max_distance;
    bool is_reciprocal;
    bool source_has_normals;
    /** Whether a plug-in asks for the moved points or normals. */
    bool needs_blob;
    /** Moves a cloud, and its normals if it has them. */
    std::function<void(const Source&, Source&, const Matrix4&)> transform;
  };

  /** The plug-ins have the target, from ICP or giveTargetToPlugins(). */
  PluginSearch(const Plugins& plugins,
               const SourceConstPtr& source,
               const IndicesConstPtr& usable,
               const TargetConstPtr& target)
  : PairSearch<PointTarget>(usable, target)
  , plugins_(plugins)
  , source_(source)
  , all_of_batch_(*plugins.estimation, IndicesPtr())
  {}

  Correspondences
  findPairs(const bayesian_icp::Vector6d& pose,
            const std::vector<std::size_t>& source_indices,
            const Eigen::Matrix3Xd& moved_points) const override
  {
    if (!canBeQueried(moved_points)) // a pose that has run away
      return (Correspondences());
    const auto batch = moveBatch(pose, source_indices);
    PCLPointCloud2::Ptr batch_blob;
    if (plugins_.needs_blob) {
      batch_blob.reset(new PCLPointCloud2);
      toPCLPointCloud2(*batch, *batch_blob);
    }
    const Correspondences pairs =
        plugins_.default_search
            ? plugins_.default_search->findPairs(pose, source_indices, moved_points)
            : estimate(batch, batch_blob);
    return (reject(pairs, source_indices, batch_blob));
  }

  bool
  isThreadSafe() const override
  {
    return (false);
  }

private:
  typename Source::Ptr
  moveBatch(const bayesian_icp::Vector6d& pose,
            const std::vector<std::size_t>& source_indices) const
  {
    typename Source::Ptr batch(new Source);
    copyPointCloud(
        *source_, Indices(source_indices.begin(), source_indices.end()), *batch);
    const Matrix4 T = bayesian_icp::matrixOf(pose).template cast<Scalar>();
    plugins_.transform(*batch, *batch, T);
    return (batch);
  }

  Correspondences
  estimate(const SourceConstPtr& batch,
           const PCLPointCloud2::ConstPtr& batch_blob) const
  {
    Correspondences pairs;
    plugins_.estimation->setInputSource(batch);
    if (plugins_.estimation->requiresSourceNormals())
      plugins_.estimation->setSourceNormals(batch_blob);
    if (plugins_.is_reciprocal)
      plugins_.estimation->determineReciprocalCorrespondences(pairs,
                                                              plugins_.max_distance);
    else
      plugins_.estimation->determineCorrespondences(pairs, plugins_.max_distance);
    return (pairs);
  }

  Correspondences
  reject(const Correspondences& estimated,
         const std::vector<std::size_t>& source_indices,
         const PCLPointCloud2::ConstPtr& batch_blob) const
  {
    CorrespondencesPtr pairs(new Correspondences(estimated));
    for (const auto& rejector : plugins_.rejectors) {
      const bool is_given_batch =
          rejector->requiresSourcePoints() || rejector->requiresSourceNormals();
      if (rejector->requiresSourcePoints())
        rejector->setSourcePoints(batch_blob);
      if (rejector->requiresSourceNormals() && plugins_.source_has_normals)
        rejector->setSourceNormals(batch_blob);
      // A rejector that is not given the mini-batch may have data of its own for the
      // points of the source, and knows them by their index there.
      if (!is_given_batch)
        for (auto& pair : *pairs)
          pair.index_query = static_cast<index_t>(
              source_indices[static_cast<std::size_t>(pair.index_query)]);
      rejector->setInputCorrespondences(pairs);
      const CorrespondencesPtr remaining(new Correspondences);
      rejector->getCorrespondences(*remaining);
      if (!is_given_batch)
        countColumns(source_indices, *remaining);
      pairs = remaining;
    }
    return (*pairs);
  }

  /** From indices in the source to columns of the mini-batch. Where a point was drawn
   * twice, any of its columns will do: they are equal. */
  static void
  countColumns(const std::vector<std::size_t>& source_indices, Correspondences& pairs)
  {
    std::unordered_map<index_t, index_t> columns;
    for (std::size_t i = 0; i < source_indices.size(); ++i)
      columns[static_cast<index_t>(source_indices[i])] = static_cast<index_t>(i);
    for (auto& pair : pairs)
      pair.index_query = columns.at(pair.index_query);
  }

  Plugins plugins_;
  SourceConstPtr source_;
  /** The estimation's own indices do not count points of a mini-batch. */
  SourceIndices<Estimation> all_of_batch_;
};

} // namespace bayesian_icp_detail
} // namespace pcl
