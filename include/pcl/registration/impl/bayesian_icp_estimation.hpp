/** \file
 * \brief PCL's default correspondence estimation, answered by this library's tree.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <pcl/common/copy_point.h>
#include <pcl/registration/impl/bayesian_icp_search.hpp>

#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace pcl {
namespace bayesian_icp_detail {

/** This library's tree over a target, kept while the target's points stay the same. */
template <typename PointTarget>
class TargetTree {
public:
  /** Make the tree that of \p target.
   * \param[in] target its points may have changed since they were last given
   * \param[in] num_threads to build with, 0: as OpenMP would
   * \return whether it is the cloud that was given last, with points that have changed
   *         or were not looked at then: a tree of PCL's need not know of that */
  bool
  update(const PointCloud<PointTarget>& target, int num_threads)
  {
    Eigen::Matrix3Xf points = pointMatrix<float>(target);
    const bool is_given_again = last_target_ == &target;
    last_target_ = &target;
    if (tree_ && areSame(points, tree_->points()))
      return (false);
    tree_ =
        std::make_shared<const bayesian_icp::KdTree>(std::move(points), num_threads);
    return (is_given_again);
  }

  /** Note that \p target is used, without looking at its points. */
  void
  skip(const PointCloud<PointTarget>& target)
  {
    last_target_ = &target;
    tree_.reset();
  }

  const std::shared_ptr<const bayesian_icp::KdTree>&
  get() const
  {
    return (tree_);
  }

private:
  /** To the last bit: points that are not finite are not equal to themselves. */
  static bool
  areSame(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b)
  {
    return (a.cols() == b.cols() &&
            std::memcmp(a.data(),
                        b.data(),
                        static_cast<std::size_t>(a.size()) * sizeof(float)) == 0);
  }

  std::shared_ptr<const bayesian_icp::KdTree> tree_;
  /** Only ever compared. */
  const void* last_target_ = nullptr;
};

/** Finds the pairs that PCL's estimation would, in parallel, beginning with the last
 * neighbour of each source point.
 *
 * Squared distances are computed as FLANN's are, so pairs are the same to the last bit
 * where one target point is the nearest. Where several are exactly as near (such as
 * repeated points), PCL's tree is asked which of them it takes. A tree whose search
 * need not be exact (setEpsilon(), which PCL does not tell of) is searched exactly. */
template <typename PointSource, typename PointTarget, typename Scalar>
class SeededEstimation
: public registration::CorrespondenceEstimation<PointSource, PointTarget, Scalar> {
public:
  using Base = registration::CorrespondenceEstimation<PointSource, PointTarget, Scalar>;
  using BasePtr = typename registration::
      CorrespondenceEstimationBase<PointSource, PointTarget, Scalar>::Ptr;

  /** \param[in] target_tree over the points of \p pcl_tree
   * \param[in] pcl_tree default search tree, built
   * \param[in] num_threads 0: as OpenMP would; the pairs do not depend on it */
  SeededEstimation(std::shared_ptr<const bayesian_icp::KdTree> target_tree,
                   const typename Base::KdTreePtr& pcl_tree,
                   int num_threads)
  : target_tree_(std::move(target_tree))
  , num_threads_(num_threads)
  {
    this->setSearchMethodTarget(pcl_tree, true);
  }

  /** As PCL's, for all points of the source. */
  void
  determineCorrespondences(
      Correspondences& correspondences,
      double max_distance = std::numeric_limits<double>::max()) override
  {
    const double max_squared_distance = max_distance * max_distance;
    constexpr float max_float = std::numeric_limits<float>::max();
    target_tree_->nearestOfAll(pointMatrix<float>(*this->input_),
                               // A gate that is not a number is none, as in PCL.
                               max_squared_distance < max_float
                                   ? static_cast<float>(max_squared_distance)
                                   : max_float,
                               neighbors_,
                               num_threads_);
    correspondences.clear();
    correspondences.reserve(neighbors_.size());
    for (std::size_t i = 0; i < neighbors_.size(); ++i) {
      const auto& neighbor = neighbors_[i];
      if (neighbor.index != bayesian_icp::KdTree::none &&
          !(neighbor.squared_distance > max_squared_distance))
        correspondences.emplace_back(static_cast<index_t>(i),
                                     neighbor.is_tied
                                         ? pclsChoice((*this->input_)[i])
                                         : static_cast<index_t>(neighbor.index),
                                     neighbor.squared_distance);
    }
  }

  BasePtr
  clone() const override
  {
    return (BasePtr(new SeededEstimation(*this)));
  }

private:
  /** Index of the point that PCL's tree finds, of several that are equally near. */
  index_t
  pclsChoice(const PointSource& point)
  {
    copyPoint(point, query_);
    this->tree_->nearestKSearch(query_, 1, index_, squared_distance_);
    return (index_[0]);
  }

  std::shared_ptr<const bayesian_icp::KdTree> target_tree_;
  int num_threads_;
  /** Of the last step, one a source point. */
  std::vector<bayesian_icp::KdTree::Neighbor> neighbors_;
  PointTarget query_;
  Indices index_ = Indices(1);
  std::vector<float> squared_distance_ = std::vector<float>(1);
};

} // namespace bayesian_icp_detail
} // namespace pcl
