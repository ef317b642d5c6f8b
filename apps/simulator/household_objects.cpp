#include "simulator/household_objects.h"

#include "simulator/distance_functions.h"

#include <algorithm>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {
constexpr double mug_radius = 0.04;
constexpr double mug_wall = 0.004;
} // namespace

double
bowlDistance(const Vector3d& point)
{
  constexpr double sphere_radius = 0.085;
  constexpr double half_thickness = 0.0025;
  constexpr double rim_below_centre = 0.02;
  constexpr double centre_height = bowl_height - half_thickness + rim_below_centre;
  const double shell = sphericalBowlDistance(point - Vector3d(0.0, 0.0, centre_height),
                                             sphere_radius,
                                             -rim_below_centre,
                                             half_thickness);
  // The foot ends inside the wall of the shell.
  const double foot = cylinderDistance(point, 0.025, 0.0095);
  return std::min(shell, foot);
}

double
canDistance(const Vector3d& point)
{
  constexpr double recess_depth = 0.005;
  const Vector3d from_recess = point - Vector3d(0.0, 0.0, can_height - recess_depth);
  const double recess = cylinderDistance(from_recess, 0.027, 2.0 * recess_depth);
  return std::max(cylinderDistance(point, 0.033, can_height), -recess);
}

double
mugBodyDistance(const Vector3d& point)
{
  const double outside = cylinderDistance(point, mug_radius, mug_height);
  const double inside = cylinderDistance(
      point - Vector3d(0.0, 0.0, mug_wall), mug_radius - mug_wall, mug_height);
  return std::max(outside, -inside);
}

double
mugHandleDistance(const Vector3d& point)
{
  const Vector3d centre(mug_radius, 0.0, 0.5 * mug_height);
  const double ring = torusDistance(point - centre, 0.028, 0.007);
  // Half of the ring lies in the cup: keep what is outside the middle of its wall.
  const double inside_cup =
      cylinderDistance(point, mug_radius - 0.5 * mug_wall, mug_height);
  return std::max(ring, -inside_cup);
}

} // namespace bayesian_icp::simulator
