/** \file
 * \brief What the viewer can show, each part of which can be switched on and off.
 */
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief From Deviation on they are about the posterior, so that there must be draws.
 */
enum class Layer { Source, Target, Aligned, Deviation, Draws, Position, Rotation };

/** \brief How users call a layer. */
struct LayerName {
  Layer layer;
  const char* name;
  /** Switches it in the window; none of pcl_viewer's keys. */
  char key;
  const char* help;
};

constexpr std::array<LayerName, 7> layer_names = {
    {{Layer::Source, "source", 'b', "the source at the guess (before)"},
     {Layer::Target, "target", 't', "the target"},
     {Layer::Aligned, "aligned", 'a', "the source, moved by the final transformation"},
     {Layer::Deviation,
      "deviation",
      'm',
      "the source, moved by the posterior mean and coloured by the standard deviation "
      "of each point over all draws [mm or m]"},
     {Layer::Draws, "draws", 'd', "the source, moved by some of the draws"},
     {Layer::Position,
      "position",
      'v',
      "the ellipsoid of 95 % (3 degrees of freedom) of the position, at the mean"},
     {Layer::Rotation,
      "rotation",
      'z',
      "the cones that the source's axes x, y, z sweep within 95 % (3 degrees of "
      "freedom), at the mean"}}};

using Layers = std::set<Layer>;

/** \brief One picture in the window. */
struct Panel {
  std::string title;
  Layers layers;
};

inline const LayerName&
nameOf(Layer layer)
{
  return layer_names[static_cast<std::size_t>(layer)];
}

} // namespace bayesian_icp::viewer
