#include "simulator/scene_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

/** Household objects are signed distances [m]. Each stands on the plane z = 0 of its
 * own frame with the z axis as its axis. Heights of the objects [m]. */
constexpr double bowl_height = 0.076;
constexpr double can_height = 0.12;
constexpr double mug_height = 0.10;
constexpr double mug_radius = 0.04;
constexpr double mug_wall = 0.004;

/** Torus centred at the origin, its ring in the x-z plane. */
double
torusDistance(const Vector3d& point, double ring_radius, double tube_radius)
{
  const double from_ring = length(point.x(), point.z()) - ring_radius;
  return length(from_ring, point.y()) - tube_radius;
}

/** Spherical shell with a round rim: the part below the plane z = \p rim_height of a
 * sphere about the origin, thickened by \p half_thickness to both sides. */
double
sphericalBowlDistance(const Vector3d& point,
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

/** Bowl, 170 mm wide, with a round rim and a foot. */
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

/** Soda can, radius 33 mm, with a recessed lid. */
double
canDistance(const Vector3d& point)
{
  constexpr double recess_depth = 0.005;
  const Vector3d from_recess = point - Vector3d(0.0, 0.0, can_height - recess_depth);
  const double recess = cylinderDistance(from_recess, 0.027, 2.0 * recess_depth);
  return std::max(cylinderDistance(point, 0.033, can_height), -recess);
}

/** Cup of the mug: radius 40 mm, wall and bottom 4 mm. */
double
mugBodyDistance(const Vector3d& point)
{
  const double outside = cylinderDistance(point, mug_radius, mug_height);
  const double inside = cylinderDistance(
      point - Vector3d(0.0, 0.0, mug_wall), mug_radius - mug_wall, mug_height);
  return std::max(outside, -inside);
}

/** Handle of the mug, on the side of the positive x axis. */
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

/** \brief Mug with its handle on the +x side (visible from -y), or on the +y side. */
std::vector<ScenePart>
mugParts(const Vector3d& origin, bool handle_to_y)
{
  const auto handle = [handle_to_y](const Vector3d& point) {
    return mugHandleDistance(handle_to_y ? Vector3d(point.y(), -point.x(), point.z())
                                         : point);
  };
  return {{"mug body", movedTo(origin, mugBodyDistance)},
          {"mug handle", movedTo(origin, handle)}};
}

/** \brief Moves the middle of the height of an object to the origin. */
DistanceFunction
centred(double height, DistanceFunction distance)
{
  return movedTo({0.0, 0.0, -0.5 * height}, std::move(distance));
}

double
cartonDistance(const Vector3d& point)
{
  const double outside = boxDistance(point, {-0.1, -0.075, 0.0}, {0.1, 0.075, 0.12});
  const double inside =
      boxDistance(point, {-0.096, -0.071, 0.005}, {0.096, 0.071, 0.175});
  return std::max(outside, -inside);
}

} // namespace

std::vector<Scene>
objectScenes()
{
  const char* turn = "rotation about its vertical axis";
  const Vector3d middle_of_mug(0.0, 0.0, -0.5 * mug_height);
  const ScenePart table_top = box("table top", {-0.6, -0.4, -0.03}, {0.6, 0.4, 0.0});
  std::vector<ScenePart> table = mugParts({-0.08, -0.2, 0.0}, false);
  table.insert(table.end(),
               {table_top,
                {"can", movedTo({-0.3, 0.12, 0.0}, canDistance)},
                {"bowl", movedTo({0.22, -0.12, 0.0}, bowlDistance)},
                box("carton", {0.05, 0.12, 0.0}, {0.21, 0.18, 0.22}),
                box("book", {-0.5, -0.25, 0.0}, {-0.29, -0.1, 0.025})});
  return {{"bowl",
           "a bowl, 170 mm wide and 76 mm high",
           turn,
           {{"bowl", centred(bowl_height, bowlDistance)}}},
          {"can",
           "a soda can, radius 33 mm, 120 mm high",
           turn,
           {{"can", centred(can_height, canDistance)}}},
          {"mug",
           "a mug, radius 40 mm, 100 mm high, handle in full view",
           "nothing",
           mugParts(middle_of_mug, false)},
          {"mug_hidden_handle",
           "the same mug, turned so that its handle is behind it",
           turn,
           mugParts(middle_of_mug, true)},
          {"table_top",
           "the empty middle of a table, its edges out of view",
           "translation along x and y, rotation about z",
           {table_top}},
          {"table_plate",
           "an empty plate, 1.0 m x 0.8 m, 40 mm thick",
           "nothing, but its edges alone hold x, y and the rotation about z",
           {box("plate", {-0.5, -0.4, -0.04}, {0.5, 0.4, 0.0})}},
          {"table",
           "a table, 1.2 m x 0.8 m, with a mug, a can, a bowl, a carton and a book",
           "nothing",
           table},
          {"box",
           "a closed box, 100 mm x 200 mm x 140 mm",
           "nothing",
           {box("box", {-0.05, -0.1, 0.0}, {0.05, 0.1, 0.14})}},
          {"bracket",
           "an L-shaped bracket of 6 mm plate, 120 mm x 80 mm, 80 mm high",
           "translation along its 120 mm edge: held by its ends only",
           {box("foot", {-0.06, -0.04, 0.0}, {0.06, 0.04, 0.006}),
            box("back", {-0.06, 0.034, 0.0}, {0.06, 0.04, 0.08})}},
          {"carton",
           "an open carton, 200 mm x 150 mm x 120 mm, walls of 4 mm",
           "nothing",
           {{"carton", cartonDistance}}},
          {"cube",
           "a cube of 0.1 m on a floor",
           "nothing",
           {floorPart(), box("cube", {-0.05, -0.05, 0.0}, {0.05, 0.05, 0.1})}},
          {"tool",
           "a hand tool, 160 mm long: handle, head and pommel",
           "nothing",
           {box("handle", {-0.08, -0.015, 0.0}, {0.08, 0.015, 0.025}),
            box("head", {0.055, -0.045, 0.0}, {0.085, 0.045, 0.04}),
            box("pommel", {-0.08, -0.012, 0.02}, {-0.06, 0.012, 0.04})}}};
}

} // namespace bayesian_icp::simulator
