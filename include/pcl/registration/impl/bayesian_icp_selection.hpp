/** \file
 * \brief Which points of the source a registration uses: those of the indices given to
 * it and to its correspondence estimation, as far as they can be searched for.
 */
#pragma once

#include <pcl/registration/impl/bayesian_icp_search.hpp>

#include <numeric>
#include <vector>

namespace pcl {
namespace bayesian_icp_detail {

/** Whether \p indices is 0, 1, ..., num_points - 1. */
inline bool
isWholeCloud(const Indices& indices, std::size_t num_points)
{
  if (indices.size() != num_points)
    return (false);
  for (std::size_t i = 0; i < num_points; ++i)
    if (indices[i] != static_cast<index_t>(i))
      return (false);
  return (true);
}

/** Those of \p indices whose point can be searched for where it is and where \p guess
 * moves it. */
template <typename PointT>
Indices
usablePoints(const PointCloud<PointT>& cloud,
             const Indices& indices,
             const Eigen::Matrix4f& guess)
{
  const Eigen::Matrix3f R = guess.topLeftCorner<3, 3>();
  const Eigen::Vector3f translation = guess.topRightCorner<3, 1>();
  Indices usable;
  usable.reserve(indices.size());
  for (const auto index : indices) {
    const Eigen::Vector3f position = cloud[index].getVector3fMap();
    const Eigen::Vector3f moved = R * position + translation;
    if (canBeQueried(position) && canBeQueried(moved))
      usable.push_back(index);
  }
  return (usable);
}

/** The source points selected by the indices of a registration and by those of its
 * correspondence estimation. The latter are taken off the estimation for the lifetime
 * of this object: they count points of the whole source, but the estimation is given
 * subsets and mini-batches of it. */
template <typename PointSource, typename PointTarget, typename Scalar>
class SourceSelection {
public:
  using Estimation =
      registration::CorrespondenceEstimationBase<PointSource, PointTarget, Scalar>;

  /** \param[in] indices those of the registration; an empty list means the whole cloud,
   *            as it does to pcl::IterativeClosestPoint */
  SourceSelection(Estimation& estimation,
                  const PointCloud<PointSource>& source,
                  const Indices& indices)
  : estimation_(estimation)
  , indices_(indices)
  {
    if (indices_.empty()) {
      indices_.resize(source.size());
      std::iota(indices_.begin(), indices_.end(), 0);
    }
    // An estimation without indices has made a list of all points of its last input.
    const auto own = estimation.getIndicesSource();
    const auto last_input = estimation.getInputSource();
    if (!own || (last_input && isWholeCloud(*own, last_input->size())))
      return;
    taken_off_ = own;
    estimation_.setIndicesSource(IndicesPtr());
    keepOnlyThose(*own, source.size());
  }
  ~SourceSelection()
  {
    if (taken_off_)
      estimation_.setIndicesSource(taken_off_);
  }
  SourceSelection(const SourceSelection&) = delete;
  SourceSelection&
  operator=(const SourceSelection&) = delete;

  const Indices&
  indices() const
  {
    return (indices_);
  }

private:
  void
  keepOnlyThose(const Indices& own, std::size_t num_points)
  {
    std::vector<bool> is_selected(num_points, false);
    for (const auto index : indices_)
      is_selected[static_cast<std::size_t>(index)] = true;
    indices_.clear();
    for (const auto index : own) {
      const auto position = static_cast<std::size_t>(index);
      if (position < num_points && is_selected[position])
        indices_.push_back(index);
    }
  }

  Estimation& estimation_;
  Indices indices_;
  IndicesPtr taken_off_;
};

} // namespace bayesian_icp_detail
} // namespace pcl
