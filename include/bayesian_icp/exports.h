/** \file
 * \brief A pose and its covariance in the conventions and text formats of other
 * robotics software: ROS 2, g2o, GTSAM, TUM trajectories, CSV.
 *
 * The pose is always the posterior mean T_target_source, because the covariance is
 * about the mean. It is the pose of the source frame in the target frame, in metres and
 * radians. Texts consist of complete lines. Their numbers do not depend on the locale
 * and read back without loss. docs/exports.md compares the formats and has examples.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/summary.h>

#include <array>
#include <cstdint>
#include <string>

namespace bayesian_icp {

/** \brief The pose to be exported. It comes from a Summary, or from a file. */
struct BAYESIAN_ICP_EXPORT PoseEstimate {
  Status status = Status::NotRun;
  /** Posterior mean T_target_source (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d mean;
  /** One covariance for each CovarianceConvention, in their order [m, rad]. */
  std::array<Matrix6d, 4> covariances;

  /** \brief An unknown estimate: all numbers are NaN. */
  PoseEstimate();
  explicit PoseEstimate(const Summary& summary);
  /** \brief One mode of \p summary. If there are several to choose from, it is
   * Doubtful, so that it can be exported: the choice is yours. */
  PoseEstimate(const Summary& summary, const Mode& mode);

  const Matrix6d&
  covariance(CovarianceConvention convention) const;
};

/** \brief Find the status with this short name, as in posterior.json.
 * \return whether it exists; if not, \p status is unchanged */
BAYESIAN_ICP_EXPORT bool
readStatus(const std::string& name, Status& status);

/** \brief Settings of the formats besides the pose. */
struct ExportOptions {
  /** Names of the frames: one or more characters of A-Z a-z 0-9 _ - . / */
  std::string target_frame = "target";
  std::string source_frame = "source";
  /** Time since the epoch, from 0 to below 2^31 s [ns]. */
  std::int64_t timestamp_ns = 0;
  /** Vertices of the pose graph: different from each other, and not negative. */
  int target_vertex = 0;
  int source_vertex = 1;
  /** Also export a posterior with status NotMixed, SeveralModes, Diverged or Cancelled,
   * if its numbers are finite. */
  bool accept_unreliable = false;

  /** \brief Describe the first invalid field, with its name. Empty if all fields are
   * valid. */
  BAYESIAN_ICP_EXPORT std::string
  validate() const;
};

/** \brief The reason why \p estimate cannot be exported, as part of a sentence. Empty
 * if it can be exported.
 *
 * The status has to be Ok or Doubtful (see ExportOptions::accept_unreliable). Mean and
 * covariance have to be finite. If \p needs_information, the covariance also has to be
 * conditioned well enough to be inverted. */
BAYESIAN_ICP_EXPORT std::string
complaintAboutExport(const PoseEstimate& estimate,
                     bool needs_information,
                     bool accept_unreliable = false);

/** \brief Inverse of a covariance.
 * \throws std::invalid_argument if the covariance is not finite, or if the inverse
 * would have fewer than about five correct digits */
BAYESIAN_ICP_EXPORT Matrix6d
informationOf(const Matrix6d& covariance);

/** \brief Convert CovarianceConvention::RightSE3 \p right_se3 to g2o's coordinates of
 * an SE(3) edge: translation [m], then the vector part of the unit quaternion, both of
 * T_mean^-1 T. The vector part is half of the angles of RightSE3. */
BAYESIAN_ICP_EXPORT Matrix6d
g2oCovariance(const Matrix6d& right_se3);

/** \brief Convert CovarianceConvention::RightSE3 \p right_se3 to GTSAM's coordinates of
 * a Pose3: the same errors, rotation first. */
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

/** \brief The 4x4 matrix of the pose, GTSAM's 6x6 covariance and the 6x6 information as
 * rows of numbers. Lines that begin with # separate them.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
gtsamText(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief A geometry_msgs/msg/PoseWithCovarianceStamped in the YAML that `ros2 topic
 * pub` accepts. frame_id is the target's; the covariance is that of
 * CovarianceConvention::R3xSO3.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
rosYaml(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief One line of a TUM trajectory: "timestamp x y z qx qy qz qw".
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
tumLine(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief The covariance of tumLine(): the same timestamp, then the 36 numbers of
 * CovarianceConvention::R3xSO3, row by row.
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
tumCovarianceLine(const PoseEstimate& estimate, const ExportOptions& options);

/** \brief A header with units and one row: timestamp, frames, status, the six
 * parameters and the upper triangle of their covariance
 * (CovarianceConvention::Parameters).
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
BAYESIAN_ICP_EXPORT std::string
csvText(const PoseEstimate& estimate, const ExportOptions& options);

} // namespace bayesian_icp
