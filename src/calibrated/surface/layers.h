/** \file
 * \brief Layers: parallel sheets of points, like the two faces of a wall.
 */
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <optional>

namespace bayesian_icp {

/** \brief One point per row, so that loops over points are vectorised. */
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/** \brief Principal axes of points. */
struct PrincipalFrame {
  /** Of the points. */
  Eigen::Vector3d mean;
  /** Columns: widest, second, normal. The second is zero if the cloud lies in a plane.
   */
  Eigen::Matrix3d axes;
  /** Along the axes, not negative [m^2]. */
  Eigen::Vector3d variances;

  /** Standard deviation across the surface [m]. */
  double
  thickness() const
  {
    return std::sqrt(variances[2]);
  }
};

/** \brief The layer of the origin, next to another one. */
struct Layer {
  /** Across the layers; its component along the smallest principal axis is 1. */
  Eigen::Vector3d axis;
  /** Place halfway between the layers along the axis. */
  double threshold;
};

/** \brief The layer of the origin, if the points around it are in two layers, one
 * behind the other. Layers are one if they are less than six standard deviations of the
 * points' distances apart; of wide layers, less than 8.7.
 *
 * \param[in] points relative to one of them
 * \param[in] frame of the points */
std::optional<Layer>
ownLayer(const PointRows& points, const PrincipalFrame& frame);

/** \brief Keep the points that are in a layer. */
void
keepLayer(const Layer& layer, PointRows& points);

} // namespace bayesian_icp
