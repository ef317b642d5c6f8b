/** \file
 * \brief What pcl_bayesian_icp has written, back from its files.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <array>
#include <string>

namespace bayesian_icp::io {

/** \brief Name and version of the layout of posterior.json; a change that breaks
 * readers is a new version. */
constexpr const char* posterior_schema_name = "pcl_bayesian_icp/posterior";
constexpr int posterior_schema_version = 1;

/** \brief First line of samples.csv. */
constexpr const char* samples_header =
    "chain,draw,x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad";

/** \brief What tools use of a posterior.json. Numbers that are null there are NaN. */
struct PosteriorFile {
  /** Names of the clouds' files as they were given to the program. */
  std::string source_file;
  std::string target_file;
  /** Of all points of the clouds, finite or not, and of the draws in samples.csv. */
  Eigen::Index num_source_points = 0;
  Eigen::Index num_target_points = 0;
  Eigen::Index num_draws = 0;
  /** Short name of the Status, and the status in words. */
  std::string status;
  std::string status_message;
  /** T_target_source at which ICP and the chains started. */
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  /** T_target_source that the program decided on: ICP's, or that of the mean. */
  Eigen::Matrix4d final_matrix = Eigen::Matrix4d::Identity();
  /** Posterior mean (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d mean = Vector6d::Zero();
  /** One for each CovarianceConvention, in their order [m, rad]. */
  std::array<Matrix6d, 4> covariances{};

  const Matrix6d&
  covariance(CovarianceConvention convention) const
  {
    return covariances[static_cast<std::size_t>(convention)];
  }
};

/** \brief Read a posterior.json of at most 16 MB.
 * \throws FileError if it cannot be read, is no posterior of a known version, or lacks
 * or garbles something of the above */
PosteriorFile
readPosterior(const std::string& name);

/** \brief Read the draws of a samples.csv of at most 1 GB, one pose a row [m, rad].
 * \throws FileError if it cannot be read, has no draws, or a row that is not two
 * indices and six finite numbers */
PoseMatrix
readSamples(const std::string& name);

} // namespace bayesian_icp::io
