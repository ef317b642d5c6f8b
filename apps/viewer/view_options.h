/** \file
 * \brief How the viewer shows what it shows.
 */
#pragma once

#include "viewer/geometry/color_map.h"
#include "viewer/layers.h"

#include <string>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief The point of the source whose position's covariance is shown. */
enum class Reference { Centroid, Origin };

struct ViewOptions {
  /** \name As pcl_viewer's options
   * \{ */
  Color background = {0.0, 0.0, 0.0};
  /** Of source, target and aligned source, as far as given. */
  std::vector<Color> foregrounds;
  std::vector<int> point_sizes;
  std::vector<double> opacities;
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

  /** \brief The pictures in the window: one of the chosen layers, or with -multiview
   * one a question. Without draws the aligned source takes the place of what needs
   * them. */
  std::vector<Panel>
  panels(bool has_draws) const;
};

} // namespace bayesian_icp::viewer
