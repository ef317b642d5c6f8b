/** \file
 * \brief A mini-batch of the source with its correspondences at a pose.
 */
#pragma once

#include "paper/likelihood.h"
#include "sampler/mini_batch.h"

#include <bayesian_icp/correspondence.h>

namespace bayesian_icp {

/** \brief Draws mini-batches and finds their correspondences, in its own buffers. It
 * shares the source and the search, and only reads them. */
class MatchedBatch {
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

  /** \brief Keep only the pair with the nearest source point of the mini-batch for each
   * target point; of equally near ones, keep the first. Target points at exactly the
   * same place count as one. */
  void
  makeOneToOne();

  /** \brief meanGradient() of the mini-batch at the pose of its draw(). */
  Vector6d
  meanGradient() const
  {
    return bayesian_icp::meanGradient(pose_, points_, moved_points_, correspondences_);
  }

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
