/** \file
 * \brief A pose and its covariance in the conventions and text formats of other
 * robotics software: ROS 2, g2o, GTSAM, TUM trajectories, CSV.
 *
 * The pose is always the posterior mean T_target_source, which the covariance is about:
 * the source frame as seen from the target frame, in metres and radians. Texts consist
 * of whole lines; numbers do not depend on the locale and read back without loss.
 * docs/exports.md has the formats side by side, with examples.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/summary.h>

#include <array>
#include <cstdint>
#include <string>

namespace bayesian_icp {

/** \brief What is exported: of a Summary, or of one that was read from a file. */
struct BAYESIAN_ICP_EXPORT PoseEstimate {
  Status status = Status::NotRun;
  /** Posterior mean T_target_source (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d mean;
  /** One for each CovarianceConvention, in their order [m, rad]. */
  std::array<Matrix6d, 4> covariances;

  /** \brief Nothing is known: all numbers are NaN. */
  PoseEstimate();
  explicit PoseEstimate(const Summary& summary);

  const Matrix6d&
  covariance(CovarianceConvention convention) const;
};

/** \brief The status of this short name, as posterior.json has it.
 * \return whether there is one; \p status is unchanged if not */
BAYESIAN_ICP_EXPORT bool
readStatus(const std::string& name, Status& status);

/** \brief What the formats want to know beside the pose. */
struct ExportOptions {
  /** Names of the frames: one or more characters of A-Z a-z 0-9 _ - . / */
  std::string target_frame = "target";
  std::string source_frame = "source";
  /** Time since the epoch, from 0 to below 2^31 s [ns]. */
  std::int64_t timestamp_ns = 0;
  /** Vertices of the pose graph; different, and not negative. */
  int target_vertex = 0;
  int source_vertex = 1;
  /** Also export a posterior that has not mixed, has several modes, lost chains or was
   * cancelled, as long as its numbers are there. */
  bool accept_unreliable = false;

  /** \brief What is wrong with the first bad field, with its name; empty if all is
   * well. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief Why \p estimate cannot be exported, as a part of a sentence; empty if it can.
 *
 * Its status has to be Ok or Doubtful (see ExportOptions::accept_unreliable), mean and
 * covariance finite and, if \p needs_information, the covariance well enough
 * conditioned to be inverted. */
BAYESIAN_ICP_EXPORT std::string
complaintAboutExport(const PoseEstimate& estimate,
                     bool needs_information,
                     bool accept_unreliable = false);

/** \brief Inverse of a covariance.
 * \throws std::invalid_argument if it is not finite, or so near to singular that fewer
 * than about five digits of the inverse would be right */
BAYESIAN_ICP_EXPORT Matrix6d
informationOf(const Matrix6d& covariance);

/** \brief Covariance in g2o's coordinates of an SE(3) edge: translation [m], then
 * vector part of the unit quaternion, both of T_mean^-1 T; that is half the angles of
 * CovarianceConvention::RightSE3 \p right_se3. */
BAYESIAN_ICP_EXPORT Matrix6d
g2oCovariance(const Matrix6d& right_se3);

/** \brief Covariance in GTSAM's coordinates of a Pose3: those of
 * CovarianceConvention::RightSE3 \p right_se3, rotation first. */
BAYESIAN_ICP_EXPORT Matrix6d
gtsamCovariance(const Matrix6d& right_se3);

/** \brief "EDGE_SE3:QUAT i j x y z qx qy qz qw" and the upper triangle of the
 * information, row by row; i is the target's vertex, j the source's.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
g2oEdge(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief "VERTEX_SE3:QUAT id x y z qx qy qz qw" of a pose in the graph's frame.
 * \throws std::invalid_argument if the pose is not finite or \p id negative */
BAYESIAN_ICP_EXPORT std::string
g2oVertex(const Eigen::Matrix4d& pose, int id);

/** \brief Rows of numbers below lines that begin with #: the 4x4 matrix of the pose,
 * GTSAM's 6x6 covariance and the 6x6 information.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
gtsamText(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief A geometry_msgs/msg/PoseWithCovarianceStamped as the YAML that `ros2 topic
 * pub` takes: frame_id is the target's, covariance of CovarianceConvention::R3xSO3.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
rosYaml(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief A line of a TUM trajectory: "timestamp x y z qx qy qz qw".
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
tumLine(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief The covariance that belongs to tumLine(): the same timestamp, then 36
 * numbers, row by row, of CovarianceConvention::R3xSO3.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
tumCovarianceLine(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief A header with units and a row: timestamp, frames, status, the six parameters
 * and the upper triangle of their covariance, CovarianceConvention::Parameters.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
csvText(const PoseEstimate& estimate, const ExportOptions& options);

} // namespace bayesian_icp
