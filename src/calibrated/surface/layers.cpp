#include "calibrated/surface/layers.h"

#include <Eigen/LU>

#include <algorithm>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/** Largest share of the variance across the layers that they leave unexplained: that of
 * layers six standard deviations apart. */
constexpr double max_unexplained = 0.1;
/** Layers whose distance is below near, in units of the points' root mean square in the
 * plane, must be 8.7 standard deviations apart. A few rings of a LiDAR in a tunnel look
 * like such layers that are six apart. */
constexpr double near = 0.4, max_unexplained_near = 0.05;
/** Largest offset of the layers' centroids in the plane, in units of the points' root
 * mean square there. Points to both sides of an edge are further apart. */
constexpr double max_offset = 0.5;
/** Largest slope of the layers with respect to the widest principal axes. */
constexpr double max_slope = 0.5;

/** Fewer points are not a layer. */
constexpr double min_share = 0.2;

constexpr int num_steps = 4;
/** The search goes on while the layers explain this share. Two halves of one layer
 * explain 0.64 of normal noise. */
constexpr double promising = 0.7;
/** Of the variance along the layers, so that flat clouds have layers, too. */
constexpr double ridge = 1e-9;

} // namespace

/* Alternates, as k-means does, between the sets of points that two parallel planes are
 * nearest to and the parallel planes that fit these sets best. */
std::optional<Layer>
ownLayer(const PointRows& points, const PrincipalFrame& frame)
{
  const Vector3d& variances = frame.variances;
  const auto num_points = static_cast<double>(points.rows());
  const double spread = variances[0] + variances[1];
  // In the frame, from the mean.
  Layer layer = {Vector3d::UnitZ(), 0.0};
  const auto inCloud = [&frame](const Layer& local) {
    const Vector3d axis = frame.axes * local.axis;
    return Layer{axis, local.threshold + frame.mean.dot(axis)};
  };
  Vector3d step;
  double explained = 0.0;
  for (int i = 0; i < num_steps; ++i) {
    const Layer in_cloud = inCloud(layer);
    const Eigen::VectorXd is_upper =
        (points.lazyProduct(in_cloud.axis).array() > in_cloud.threshold).cast<double>();
    const double share = is_upper.mean();
    if (!(std::min(share, 1.0 - share) > min_share))
      return std::nullopt;
    const Vector3d mean_of_upper =
        points.transpose().lazyProduct(is_upper) / (share * num_points);
    const Vector3d upper = frame.axes.transpose() * (mean_of_upper - frame.mean);
    step = upper / (1.0 - share);
    const Matrix3d between = share * (1.0 - share) * step * step.transpose();
    const Matrix3d within = Matrix3d(variances.asDiagonal()) - between;
    const Matrix2d in_plane =
        within.topLeftCorner<2, 2>() + ridge * spread * Matrix2d::Identity();
    layer.axis.head<2>() = -in_plane.inverse() * within.col(2).head<2>();
    layer.threshold = layer.axis.dot(upper - 0.5 * step);
    explained = layer.axis.dot(between * layer.axis) /
                layer.axis.dot(variances.cwiseProduct(layer.axis));
    if (explained < promising)
      return std::nullopt;
  }
  const Vector3d across =
      layer.axis * (layer.axis.dot(step) / layer.axis.squaredNorm());
  const bool are_near = across.squaredNorm() < near * near * spread;
  if (!(explained > 1.0 - (are_near ? max_unexplained_near : max_unexplained) &&
        layer.axis.head<2>().norm() < max_slope &&
        (step - across).squaredNorm() < max_offset * max_offset * spread))
    return std::nullopt;
  return inCloud(layer);
}

void
keepLayer(const Layer& layer, PointRows& points)
{
  const bool is_upper = layer.threshold < 0.0;
  Index kept = 0;
  for (Index i = 0; i < points.rows(); ++i)
    if ((points.row(i).dot(layer.axis) > layer.threshold) == is_upper)
      points.row(kept++) = points.row(i).eval();
  points.conservativeResize(kept, 3);
}

} // namespace bayesian_icp
