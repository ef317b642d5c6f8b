#include "simulator/distance_functions.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::simulator {

namespace {

/** \brief sqrt of the sum of squares: rounded alike everywhere, unlike std::hypot. */
double
length(double x, double y)
{
  return std::sqrt(x * x + y * y);
}

} // namespace

double
boxDistance(const Eigen::Vector3d& point, const Eigen::Vector3d& half_size)
{
  const Eigen::Vector3d excess = point.cwiseAbs() - half_size;
  return excess.cwiseMax(0.0).norm() + std::min(excess.maxCoeff(), 0.0);
}

double
boxDistance(const Eigen::Vector3d& point,
            const Eigen::Vector3d& lower_corner,
            const Eigen::Vector3d& upper_corner)
{
  const Eigen::Vector3d centre = 0.5 * (lower_corner + upper_corner);
  const Eigen::Vector3d half_size = 0.5 * (upper_corner - lower_corner);
  return boxDistance(point - centre, half_size);
}

double
cylinderDistance(const Eigen::Vector3d& point, double radius, double height)
{
  const double radial = length(point.x(), point.y()) - radius;
  const double axial = std::abs(point.z() - 0.5 * height) - 0.5 * height;
  return length(std::max(radial, 0.0), std::max(axial, 0.0)) +
         std::min(std::max(radial, axial), 0.0);
}

double
torusDistance(const Eigen::Vector3d& point, double ring_radius, double tube_radius)
{
  const double from_ring = length(point.x(), point.z()) - ring_radius;
  return length(from_ring, point.y()) - tube_radius;
}

double
sphericalBowlDistance(const Eigen::Vector3d& point,
                      double sphere_radius,
                      double rim_height,
                      double half_thickness)
{
  const double radial = length(point.x(), point.y());
  const double rim_radius =
      std::sqrt(sphere_radius * sphere_radius - rim_height * rim_height);
  // Seen from the sphere's centre, points above the cone through the rim are nearest to
  // the rim, the others to the sphere.
  const bool nearest_to_rim = rim_height * radial < rim_radius * point.z();
  const double middle_surface =
      nearest_to_rim ? length(radial - rim_radius, point.z() - rim_height)
                     : std::abs(length(radial, point.z()) - sphere_radius);
  return middle_surface - half_thickness;
}

} // namespace bayesian_icp::simulator
