/** \file
 * \brief Where to look from, so that points fill the picture.
 */
#pragma once

#include <Eigen/Core>

namespace bayesian_icp::viewer {

/** \brief A pinhole camera, target frame [m]. */
struct CameraPose {
  Eigen::Vector3d position = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d focal_point = Eigen::Vector3d::Zero();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
};

/** \brief Directions of a view: unit vectors from what is seen to the eye, and upwards.
 */
struct ViewDirection {
  Eigen::Vector3d to_eye;
  Eigen::Vector3d up;
};

/** \brief From the sensor if it stands outside the box of \p points, as pcl_viewer
 * does, with y downwards where it looks along z (a camera's optical frame); otherwise
 * from obliquely above, z upwards.
 * \param[in] points finite points, one in each column [m]
 * \param[in] sensor_origin [m] */
ViewDirection
defaultView(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& sensor_origin);

/** \brief The part of the picture that points may take; the whole is -1 ... 1 from left
 * to right and from bottom to top. */
struct PictureArea {
  double left = -0.9;
  double right = 0.9;
  double bottom = -0.9;
  double top = 0.9;
};

/** \brief The camera nearest to \p points that sees them all within \p area.
 * \param[in] points finite ones, at least one, one per column [m]
 * \param[in] vertical_angle angle of view from bottom to top [rad]
 * \param[in] aspect width / height of the picture */
CameraPose
fitCamera(const Eigen::Matrix3Xd& points,
          const ViewDirection& view,
          double vertical_angle,
          double aspect,
          const PictureArea& area);

} // namespace bayesian_icp::viewer
