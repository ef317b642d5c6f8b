/** \file
 * \brief A mini-batch of the source with its correspondences at a pose.
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/likelihood.h>
#include <bayesian_icp/mini_batch.h>

namespace bayesian_icp {

/** \brief Draws mini-batches and finds their correspondences, in buffers of its own.
 * The source and the search are shared and only read. */
class BAYESIAN_ICP_EXPORT MatchedBatch {
public:
  /** \param[in] source_points 3 x n, source frame [m]; must outlive this object, like
   *            \p search
   * \param[in] search finds correspondences in the target
   * \param[in] mini_batches of this chain or descent */
  MatchedBatch(const Eigen::Matrix3Xd& source_points,
               const CorrespondenceSearch& search,
               const MiniBatches& mini_batches);

  /** \brief Draw the next mini-batch and match it at \p pose. */
  void
  draw(const Vector6d& pose, Random& random);

  /** \brief Keep each target point in its pair with the nearest source point of the
   * mini-batch only, the first among equally near ones. Target points at the very same
   * place count as one. */
  void
  makeOneToOne();

  /** \brief meanGradient() of the mini-batch at the pose that it was drawn at. */
  Vector6d
  meanGradient() const;

  /** \brief Points in the mini-batch. */
  std::size_t
  numPoints() const
  {
    return static_cast<std::size_t>(points_.cols());
  }

  /** \brief Points that have a correspondence. */
  std::size_t
  numMatched() const
  {
    return correspondences_.size();
  }

private:
  const Eigen::Matrix3Xd& source_points_;
  const CorrespondenceSearch& search_;
  MiniBatches mini_batches_;
  Vector6d pose_ = Vector6d::Zero();
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd moved_points_;
  Correspondences correspondences_;
};

} // namespace bayesian_icp
