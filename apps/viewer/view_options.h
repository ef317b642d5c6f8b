/** \file
 * \brief What the viewer can show, and how.
 */
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief Red, green, blue in [0, 1]. */
using Color = std::array<double, 3>;

/** \brief From Deviation on they are about the posterior, so that there must be draws.
 */
enum class Layer { Source, Target, Aligned, Deviation, Draws, Position, Rotation };

/** \brief How users call a layer, and how they see it. */
struct LayerName {
  Layer layer;
  const char* name;
  /** Switches it in the window; none of pcl_viewer's keys. */
  char key;
  /** Apart for all kinds of colour vision (Okabe and Ito 2008). The deviations have a
   * map instead, the rotation's cones the colours of the axes. */
  Color color;
  const char* help;
};

constexpr std::array<LayerName, 7> layer_names = {
    {{Layer::Source,
      "source",
      'b',
      {0.34, 0.71, 0.91},
      "the source at the guess (before)"},
     {Layer::Target, "target", 't', {0.62, 0.62, 0.62}, "the target"},
     {Layer::Aligned,
      "aligned",
      'a',
      {0.90, 0.62, 0.00},
      "the source, moved by the final transformation"},
     {Layer::Deviation,
      "deviation",
      'm',
      {},
      "the source, moved by the posterior mean and coloured by the standard deviation "
      "of each point over all draws [mm or m]"},
     {Layer::Draws,
      "draws",
      'd',
      {0.94, 0.89, 0.26},
      "the source, moved by some of the draws"},
     {Layer::Position,
      "position",
      'v',
      {0.86, 0.35, 0.67},
      "the ellipsoid of 95 % (3 degrees of freedom) of the position, at the mean"},
     {Layer::Rotation,
      "rotation",
      'z',
      {},
      "the cones that the source's axes x, y, z sweep within 95 % (3 degrees of "
      "freedom), at the mean"}}};

using Layers = std::set<Layer>;

/** \brief Least size of a panel that can be read [pixels]. */
constexpr int least_width = 300;
constexpr int least_height = 200;

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

/** \brief The viewer's keys in words; pcl_viewer prints its own itself. */
std::string
keysText();

/** \brief The point of the source whose position's covariance is shown. */
enum class Reference { Centroid, Origin };

/** \brief How points look. */
struct PointStyle {
  Color color;
  int size;
  double opacity;
};

struct ViewOptions {
  /** \name As pcl_viewer's options
   * \{ */
  Color background = {0.0, 0.0, 0.0};
  /** Of source, target and aligned source. */
  std::array<PointStyle, 3> styles = {{{nameOf(Layer::Source).color, 3, 1.0},
                                       {nameOf(Layer::Target).color, 2, 1.0},
                                       {nameOf(Layer::Aligned).color, 3, 1.0}}};
  /** Length of the target frame's axes [m]; 0 shows none. */
  double axes_scale = 0.0;
  /** What -cam says; empty if nothing. */
  std::string camera;
  bool is_multiview = false;
  /** \} */

  Layers layers = {Layer::Target, Layer::Deviation, Layer::Position, Layer::Rotation};
  Reference reference = Reference::Centroid;
  int num_draws = 20;
  /** Factor by which deviations from the mean are magnified; 0 is automatic. */
  double magnification = 0.0;
  bool is_live = false;
  /** Empty if there is to be a window. */
  std::string screenshot_file;
  int width = 1280;
  int height = 960;
  bool is_size_given = false;

  bool
  isOffScreen() const
  {
    return !screenshot_file.empty();
  }

  /** \brief Of source, target or aligned source. */
  const PointStyle&
  styleOf(Layer layer) const
  {
    return styles[static_cast<std::size_t>(layer)];
  }

  /** \brief The pictures in the window: one of the chosen layers, or with -multiview
   * one a question. Without draws the aligned source takes the place of what needs
   * them. */
  std::vector<Panel>
  panels(bool has_draws) const;
};

} // namespace bayesian_icp::viewer
