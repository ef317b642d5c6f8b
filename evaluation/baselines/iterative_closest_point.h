/** \file
 * \brief Standard point-to-point ICP to completion, without PCL and on our own tree.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace bayesian_icp {

/** \brief When ICP stops; defaults and meaning are those of pcl::IterativeClosestPoint
 * and its DefaultConvergenceCriteria. An iteration finds pairs, then moves the source.
 */
struct IcpOptions {
  /** As there, less than 1 is one iteration. */
  int max_iterations = 10;
  /** Largest distance of corresponding points [m], inclusive. */
  double max_distance = std::numeric_limits<double>::infinity();
  /** Stop when the squared translation of one iteration [m^2] is not above it and the
   * cosine of its angle is at least rotation_epsilon; the translation is that of the
   * target frame's origin. */
  double transformation_epsilon = 0.0;
  /** Stop when the mean squared distance of the pairs differs from that of the
   * iteration before by less than this share of it; negative: never. */
  double euclidean_fitness_epsilon = -std::numeric_limits<double>::max();
  /** A cosine; if not positive, 1 - transformation_epsilon. */
  double rotation_epsilon = 0.0;
  /** Stop when the mean squared distance of the pairs differs from that of the
   * iteration before by less [m^2]; PCL calls it setAbsoluteMSE(). */
  double absolute_fitness_epsilon = 1e-12;
};

/** \brief Which option ended ICP; the first that holds, in this order. */
enum class IcpStop {
  TooFewPairs,
  MaxIterations,
  Transformation,
  AbsoluteFitness,
  RelativeFitness
};

inline constexpr std::array icp_stops = {IcpStop::TooFewPairs,
                                         IcpStop::MaxIterations,
                                         IcpStop::Transformation,
                                         IcpStop::AbsoluteFitness,
                                         IcpStop::RelativeFitness};

/** \brief Short name: "too_few_pairs", "max_iterations", "transformation",
 * "absolute_fitness", "relative_fitness". */
const char*
toString(IcpStop stop);

/** \brief Where ICP ended. */
struct IcpResult {
  /** T_target_source. */
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  /** Those that moved the source. */
  int num_iterations = 0;
  /** As pcl::Registration::hasConverged(): false only without enough pairs. Stopping at
   * max_iterations counts as converged there. */
  bool has_converged = false;
  IcpStop stop = IcpStop::TooFewPairs;
  /** Of the pairs of the last iteration, before its step [m^2]; infinite without one.
   */
  double mean_squared_distance = std::numeric_limits<double>::infinity();
};

/** \brief Run ICP from \p start: the same iterations, and so the same fixed points, as
 * pcl::IterativeClosestPoint but for rounding (PCL moves its cloud in single precision,
 * again each time; this one takes the pose in double).
 * \param[in] source 3 x n, finite, source frame [m]
 * \param[in] target points, target frame [m]
 * \param[in] start T_target_source
 * \param[in] options when to stop, and the gate
 * \return has_converged false, at the last pose, where fewer than three points have a
 *         target point within max_distance */
IcpResult
iterativeClosestPoint(const Eigen::Matrix3Xd& source,
                      const KdTree& target,
                      const Eigen::Isometry3d& start,
                      const IcpOptions& options = IcpOptions());

/** \brief ICP again and again on the same pair, without allocating; one object serves
 * one thread. */
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
