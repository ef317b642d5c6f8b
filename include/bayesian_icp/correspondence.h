/** \file
 * \brief Correspondences, and the search that finds them.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <Eigen/Core>

#include <vector>

namespace bayesian_icp {

/** \brief One source-target point pair. */
struct Correspondence {
  /** Column of the source points given to the search. */
  std::size_t source_index;
  /** The corresponding point of the target, target frame [m]. */
  Eigen::Vector3d target_point;
};

using Correspondences = std::vector<Correspondence>;

/** \brief Finds the target points that correspond to source points.
 *
 * The search applies the maximum correspondence distance (the gate): a source point
 * without a target point within the gate has no correspondence. */
class BAYESIAN_ICP_EXPORT CorrespondenceSearch {
public:
  virtual ~CorrespondenceSearch();

  /** \brief Find the correspondences of moved source points.
   * \param[in] pose source-to-target pose that moved the points [m, rad]
   * \param[in] source_indices index in the whole source of each column of \p
   *            moved_points
   * \param[in] moved_points 3 x m, source points in the target frame [m]
   * \param[out] correspondences the pairs found, at most one for each column, in the
   *            order of the columns; source_index counts columns of \p moved_points */
  virtual void
  find(const Vector6d& pose,
       const std::vector<std::size_t>& source_indices,
       const Eigen::Matrix3Xd& moved_points,
       Correspondences& correspondences) const = 0;

  /** \brief Whether several threads may call find() at the same time. */
  virtual bool
  isThreadSafe() const = 0;
};

} // namespace bayesian_icp
