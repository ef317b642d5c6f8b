/** \file
 * \brief The window, or the picture that stands in for it.
 */
#pragma once

#include "viewer/geometry/camera.h"
#include "viewer/view_options.h"

#include <memory>
#include <string>
#include <vector>

namespace bayesian_icp::io {
class OutputFolder;
}

namespace pcl::visualization {
class PCLVisualizer;
}

namespace bayesian_icp::viewer {

/** \brief Make sure that the X display answers; VTK, off-screen too, aborts the program
 * where none does.
 * \throws std::runtime_error that says what to do */
void
requireDisplay();

/** \brief A PCLVisualizer with panels, set up as the user asked. */
class Window {
public:
  /** \brief There must be a display: see requireDisplay().
   * \param[in] cloud_files pcl_viewer keeps saved cameras (Ctrl-S) under their names
   * \throws io::UsageError if the options' camera cannot be understood */
  Window(const ViewOptions& options, const std::vector<std::string>& cloud_files);
  Window(const Window&) = delete;
  Window&
  operator=(const Window&) = delete;

  pcl::visualization::PCLVisualizer&
  visualizer()
  {
    return *visualizer_;
  }

  /** \brief Divide the window into a number of panels, row by row, and forget what was
   * in it.
   * \return their viewports' numbers */
  std::vector<int>
  makePanels(std::size_t number);

  /** \brief Size of one panel [pixels]. */
  Eigen::Vector2i
  panelSize() const;

  /** \brief Look at points from a direction, unless the user has given a camera. */
  void
  lookAt(const Eigen::Matrix3Xd& points,
         const ViewDirection& view,
         const PictureArea& area);

  /** \brief From now on keys switch layers and the legend; h prints keysText(), and
   * lets PCL print its own. */
  void
  handleKeys();

  /** \brief Draw, and handle what the user does, for at least so long [ms]. */
  void
  spinOnce(int milliseconds);

  /** \brief Whether the user has closed the window. */
  bool
  isClosed() const;

  /** \brief Draw, and write the picture as a PNG file \p name into \p folder.
   * \throws io::FileError if it cannot be written; then nothing is left behind */
  void
  save(const std::string& name, io::OutputFolder& folder);

private:
  /** Hides what is seen, and shows what is hidden, of everything whose name begins with
   * \p prefix. */
  void
  toggle(const std::string& prefix);

  std::shared_ptr<pcl::visualization::PCLVisualizer> visualizer_;
  bool is_off_screen_;
  bool has_users_camera_ = false;
  Eigen::Vector2i grid_{1, 1};
};

} // namespace bayesian_icp::viewer
