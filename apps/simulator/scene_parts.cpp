#include "simulator/scene_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

double
length(double x, double y)
{
  return std::sqrt(x * x + y * y);
}

double
boxDistance(const Vector3d& point,
            const Vector3d& lower_corner,
            const Vector3d& upper_corner)
{
  const Vector3d centre = 0.5 * (lower_corner + upper_corner);
  const Vector3d half_size = 0.5 * (upper_corner - lower_corner);
  const Vector3d excess = (point - centre).cwiseAbs() - half_size;
  return excess.cwiseMax(0.0).norm() + std::min(excess.maxCoeff(), 0.0);
}

double
cylinderDistance(const Vector3d& point, double radius, double height)
{
  const double radial = length(point.x(), point.y()) - radius;
  const double axial = std::abs(point.z() - 0.5 * height) - 0.5 * height;
  return length(std::max(radial, 0.0), std::max(axial, 0.0)) +
         std::min(std::max(radial, axial), 0.0);
}

DistanceFunction
movedTo(const Vector3d& origin, DistanceFunction distance)
{
  return [origin, distance = std::move(distance)](const Vector3d& point) {
    return distance(point - origin);
  };
}

ScenePart
standing(const std::string& name,
         const Vector3d& origin,
         const Vector3d& size,
         DistanceFunction distance)
{
  const Vector3d half(0.5 * size.x(), 0.5 * size.y(), 0.0);
  const Vector3d height(0.0, 0.0, size.z());
  return {name,
          movedTo(origin, std::move(distance)),
          {origin - half, origin + half + height}};
}

ScenePart
box(const std::string& name, const Vector3d& lower_corner, const Vector3d& upper_corner)
{
  return {name, [lower_corner, upper_corner](const Vector3d& point) {
            return boxDistance(point, lower_corner, upper_corner);
          }};
}

ScenePart
cylinder(const std::string& name, const Vector3d& origin, double radius, double height)
{
  return {name, movedTo(origin, [radius, height](const Vector3d& point) {
            return cylinderDistance(point, radius, height);
          })};
}

ScenePart
floorPart(const std::string& name)
{
  return {name, [](const Vector3d& point) { return point.z(); }};
}

} // namespace bayesian_icp::simulator
