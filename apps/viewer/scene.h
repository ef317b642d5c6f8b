/** \file
 * \brief What there is to show: clouds, transformations, draws.
 */
#pragma once

#include "viewer/geometry/pose_spread.h"
#include "viewer/view_options.h"

#include <Eigen/Geometry>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief What the draws of a scene say, ready to be drawn. */
struct Uncertainty {
  PoseSpread spread;
  /** Of each source point [m]. */
  Eigen::VectorXd point_deviations;
  /** Factor by which deviations from the mean are magnified. */
  double magnification = 1.0;
  /** T_target_source of the chosen draws, magnified. */
  std::vector<Eigen::Matrix4d> shown_draws;
};

/** \brief A registration and its posterior. Matrices are T_target_source. */
struct Scene {
  /** The finite points: x, y, z [m], one in each column. */
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  /** Of the clouds, points that are not finite included. */
  Eigen::Index num_source_points = 0;
  Eigen::Index num_target_points = 0;
  /** Where the target's sensor stood, target frame [m]. */
  Eigen::Vector3d sensor_origin = Eigen::Vector3d::Zero();
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d final_matrix = Eigen::Matrix4d::Identity();
  /** Of the chains that have not diverged, one pose a row [m, rad]. */
  PoseMatrix draws;
  /** What uncertaintyOf() says of the draws. */
  std::optional<Uncertainty> uncertainty;
  /** The names by which the user knows the clouds. */
  std::string source_file;
  std::string target_file;
  /** Whether the status is Ok, and the status in words. */
  bool is_ok = false;
  std::string status_text;
  /** A warning that not all of this belongs together; empty if nothing says so. */
  std::string note;
};

/** \brief How many times larger deviations are to be drawn so that the largest is at
 * most a twentieth of \p size: the largest of 1, 2, 5, 10, ... 1000 that does it, or 1.
 * \param[in] largest_deviation, size [m] */
double
niceMagnification(double largest_deviation, double size);

/** \brief Empty if there are fewer than two draws. */
std::optional<Uncertainty>
uncertaintyOf(const Scene& scene, const ViewOptions& options);

/** \brief The whole of what the layers show, as points that the picture has to hold. */
Eigen::Matrix3Xd
shownPoints(const Scene& scene, const Layers& layers);

/** \brief What the source's axes sweep within 95 % (3 degrees of freedom), magnified;
 * three cones, as long as half the source. */
std::array<Eigen::Matrix3Xd, 3>
rotationCones(const Scene& scene);

/** \brief Makes the unit ball the ellipsoid of 95 % (3 degrees of freedom) of the
 * position, magnified. */
Eigen::Affine3d
positionEllipsoid(const Scene& scene);

/** \brief Points of the source at all shown draws, a random choice of at most
 * \p max_points in all [m]. */
Eigen::Matrix3Xd
pointsAtDraws(const Scene& scene, Eigen::Index max_points);

} // namespace bayesian_icp::viewer
