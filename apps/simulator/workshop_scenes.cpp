/** \file
 * \brief Scenes of one object made of plane faces, with its edges in view.
 */
#include "simulator/scene_parts.h"

#include <algorithm>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

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
workshopScenes()
{
  return {{"box",
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
