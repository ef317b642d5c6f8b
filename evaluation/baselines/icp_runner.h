/** \file
 * \brief Internal: ICP again and again on the same pair, without allocating.
 */
#pragma once

#include "baselines/iterative_closest_point.h"

#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Runs ICP; one object serves one thread. */
class IcpRunner {
public:
  /** Both arguments must outlive this object. */
  IcpRunner(const Eigen::Matrix3Xd& source, const KdTree& target);

  /** \brief As iterativeClosestPoint(). What earlier runs found makes this one faster,
   * and changes nothing else. */
  IcpResult
  run(const Eigen::Isometry3d& start, const IcpOptions& options);

private:
  /** Sums over the pairs of one iteration. */
  struct Pairs {
    double count = 0.0;
    double squared_distances = 0.0;
    /** The points that the sums are taken about: of the moved source, of the target. */
    Eigen::Vector3d moved_origin, target_origin;
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    Eigen::Vector3d target = Eigen::Vector3d::Zero();
    /** Sum of target moved^T. */
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  };

  Pairs
  findPairs(const Eigen::Isometry3d& T_target_source, float max_squared_distance);

  static Eigen::Isometry3d
  stepOf(const Pairs& pairs);

  const Eigen::Matrix3Xd& source_;
  const KdTree& target_;
  Eigen::Vector3d source_centre_;
  /** The last neighbour of each source point. */
  std::vector<std::uint32_t> neighbors_;
};

} // namespace bayesian_icp
