/** \file
 * \brief Nearest neighbours in a KdTree as correspondences.
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/export.h>
#include <bayesian_icp/kd_tree.h>

#include <limits>

namespace bayesian_icp {

/** \brief Finds the nearest target point within the gate, in single precision like the
 * tree. */
class BAYESIAN_ICP_EXPORT TreeSearch : public CorrespondenceSearch {
public:
  /** \param[in] target must outlive this object
   * \param[in] max_distance gate [m]; infinity means no gate */
  explicit TreeSearch(const KdTree& target,
                      double max_distance = std::numeric_limits<double>::infinity());

  void
  find(const Vector6d& pose,
       const std::vector<std::size_t>& source_indices,
       const Eigen::Matrix3Xd& moved_points,
       Correspondences& correspondences) const override;

  bool
  isThreadSafe() const override;

private:
  const KdTree& target_;
  float max_squared_distance_;
};

} // namespace bayesian_icp
