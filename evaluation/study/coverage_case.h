/** \file
 * \brief One registration of the coverage study: what a method is given, and what is
 * true.
 */
#pragma once

#include "study/axis_deviation.h"
#include "study/input_hash.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <limits>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief The condition of pairs of real scans, which seeds only displace. */
constexpr const char* real_pair = "real";

/** \brief Two scans whose relative pose was drawn from the prior. The prior is about
 * the source's centroid (PriorFrame::SourceCentroid) with mean \p prior_mean. */
struct CoverageCase {
  std::string scene;
  std::string condition;
  std::uint64_t seed = 0;
  /** 3 x n, finite [m]. */
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  /** T_target_source. */
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  /** Pose and standard deviations (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d prior_mean = Vector6d::Zero();
  Vector6d prior_sd = Vector6d::Zero();
  /** Accuracy of the truth itself, root mean square over three axes; zero in
   * simulation. Of the source's centroid and the rotation, of recordings of the sensor
   * and the rotation. */
  AxisDeviation truth_sd;
  /** Of recordings: where the sensor is in the source's frame [m]. */
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();
  /** Of recordings: mean displacement of the source's points beyond which a pose is
   * lost [m]. NaN: no pose is. */
  double lost_displacement = std::numeric_limits<double>::quiet_NaN();

  /** \brief A hash of all but the names. */
  std::string
  key() const
  {
    InputHash hash;
    hash.addMatrix(source);
    hash.addMatrix(target);
    hash.addMatrix(truth.matrix());
    hash.addMatrix(prior_mean);
    hash.addMatrix(prior_sd);
    hash.addMatrix(sensor);
    for (const double limit :
         {truth_sd.translation, truth_sd.rotation, lost_displacement})
      hash.add(limit);
    return io::textOfHash(hash.value());
  }
};

/** \brief How a posterior's Mahalanobis distances are distributed. */
struct RegionShape {
  /** nu of Student's t distribution, scaled to its covariance, at least 3; 0 is a
   * Gaussian. */
  int degrees_of_freedom = 0;
  /** How many of the six directions have it; the others, which the prior holds, are
   * Gaussian. */
  int num_held = 6;
};

/** \brief What a method makes of a case. */
struct MethodResult {
  /** False if the method gave nothing; \p notes says why. */
  bool is_valid = false;
  /** T_target_source. */
  Eigen::Isometry3d mean = Eigen::Isometry3d::Identity();
  /** There is a pose, \p mean, but no posterior. */
  bool is_pose_only = false;
  /** Of left twists (v, w) about \p centre, target frame [m, rad]. */
  Matrix6d covariance = Matrix6d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /** What the posterior is about its mean, if not a Gaussian. */
  RegionShape shape;
  /** Draws, one pose a row, of methods that have any; they then take the place of the
   * Gaussian in every score. */
  PoseMatrix draws;
  /** Raised flags, each as "flag:NAME", and other remarks, separated by ';', no
   * commas. */
  std::string notes;
  double seconds = 0.0;
  /** Nearest-neighbour queries, -1 if not counted. */
  long num_queries = -1;
};

} // namespace bayesian_icp::evaluate
