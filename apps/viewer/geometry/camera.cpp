#include "viewer/geometry/camera.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

/** Smallest distance of the camera from the centre at which a point is in the area
 * lower ... upper of the picture.
 *
 * The camera is moved sideways by -distance tangent (lower + upper) / 2, so that the
 * centre is in the middle of the area. The point x, depth distance - z, is seen at
 * (x - shift) / (tangent (distance - z)); that it is not beyond either border gives a
 * lower limit of the distance each.
 * \param[in] offset from the centre: to the right, upwards, to the eye
 * \param[in] tangents of half the angles of view */
double
distanceFor(const Eigen::Vector3d& offset,
            const Eigen::Vector2d& tangents,
            const Eigen::Vector2d& lower,
            const Eigen::Vector2d& upper)
{
  const Eigen::Array2d x = offset.head<2>().array() / tangents.array();
  const Eigen::Array2d half = 0.5 * (upper - lower).array();
  const Eigen::Array2d for_upper = (x + upper.array() * offset.z()) / half;
  const Eigen::Array2d for_lower = (-x - lower.array() * offset.z()) / half;
  return for_upper.max(for_lower).maxCoeff();
}

} // namespace

ViewDirection
defaultView(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& sensor_origin)
{
  const Eigen::Vector3d lower = points.rowwise().minCoeff();
  const Eigen::Vector3d upper = points.rowwise().maxCoeff();
  const bool is_inside = (sensor_origin.array() >= lower.array()).all() &&
                         (sensor_origin.array() <= upper.array()).all();
  if (is_inside)
    return {Eigen::Vector3d(-0.6, -1.0, 0.6).normalized(), Eigen::Vector3d::UnitZ()};
  const Eigen::Vector3d to_eye = (sensor_origin - 0.5 * (lower + upper)).normalized();
  const bool looks_along_z = std::abs(to_eye.z()) > std::sqrt(0.5);
  return {to_eye,
          looks_along_z ? Eigen::Vector3d(-Eigen::Vector3d::UnitY())
                        : Eigen::Vector3d::UnitZ()};
}

CameraPose
fitCamera(const Eigen::Matrix3Xd& points,
          const ViewDirection& view,
          double vertical_angle,
          double aspect,
          const PictureArea& area)
{
  Eigen::Matrix3d axes; // rows: to the right, upwards, to the eye
  axes.row(2) = view.to_eye.transpose();
  axes.row(0) = view.up.cross(view.to_eye).normalized().transpose();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  const Eigen::Matrix3Xd seen = axes * points;
  const Eigen::Vector3d centre =
      0.5 * (seen.rowwise().minCoeff() + seen.rowwise().maxCoeff());
  const double vertical = std::tan(0.5 * vertical_angle);
  const Eigen::Vector2d tangents(vertical * aspect, vertical);
  const Eigen::Vector2d lower(area.left, area.bottom), upper(area.right, area.top);
  double distance = 0.0;
  for (Eigen::Index i = 0; i < seen.cols(); ++i)
    distance =
        std::max(distance, distanceFor(seen.col(i) - centre, tangents, lower, upper));
  // A single point has no size; stay a metre away.
  distance = distance > 0.0 ? distance : 1.0;
  const Eigen::Vector2d shift = -0.5 * distance * tangents.cwiseProduct(lower + upper);
  CameraPose camera;
  camera.focal_point =
      axes.transpose() * (centre + Eigen::Vector3d(shift.x(), shift.y(), 0.0));
  camera.position = camera.focal_point + distance * view.to_eye;
  camera.up = axes.row(1).transpose();
  return camera;
}

} // namespace bayesian_icp::viewer
