/** \file
 * \brief The window, or the picture that stands in for it, and what is written over
 * what it shows: legend, status, colour bar.
 */
#pragma once

#include "viewer/geometry/camera.h"
#include "viewer/legend.h"
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

class vtkActor2D;

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

  /** \brief How many characters a line of a panel has room for, beside the colour bar
   * if it has one. */
  std::size_t
  lineWidth(bool has_color_bar) const;

  /** \brief Whether so many lines of legend and status leave a third of a panel's
   * height to what it shows. */
  bool
  hasRoomFor(std::size_t num_lines) const;

  /** \brief The area of a panel that a legend, the status and a colour bar leave free;
   * at least the upper half but for the legend, however long the status is. */
  PictureArea
  areaBeside(std::size_t num_legend_lines,
             std::size_t num_status_lines,
             bool has_color_bar) const;

  /** \brief Write lines into the upper left corner of a panel, under names that begin
   * with "legend". */
  void
  addLegend(const std::vector<LegendLine>& lines, int viewport);

  /** \brief Write what the registration came to along the lower edge of a panel. */
  void
  addStatus(const std::vector<LegendLine>& lines, int viewport);

  /** \brief Write x, y or z where an axis ends [m], in front of all that is drawn,
   * under a name that begins with \p id. */
  void
  addAxisName(std::size_t axis,
              const Eigen::Vector3d& end,
              const Color& color,
              const std::string& id,
              int viewport);

  /** \brief A bar with ticks in mm or m at the right of a panel, from 0 to \p maximum
   * [m], under a name that begins with "legend". */
  void
  addColorBar(double maximum, const Color& text_color, int viewport);

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

  /** Of one panel [pixels], as are the three below. */
  Eigen::Vector2i
  panelSize() const;

  int
  fontSize() const;

  /** From one line of text to the next. */
  int
  lineHeight() const;

  /** Of a colour bar with its numbers. */
  int
  barWidth() const;

  /** Writes at the left of a panel, the first line \p y pixels above its lower edge,
   * under names that begin with \p prefix. */
  void
  write(const std::vector<LegendLine>& lines,
        int y,
        const std::string& prefix,
        int viewport);

  void
  addActor(vtkActor2D* actor, const std::string& id, int viewport);

  std::shared_ptr<pcl::visualization::PCLVisualizer> visualizer_;
  bool is_off_screen_;
  bool has_users_camera_ = false;
  Eigen::Vector2i grid_{1, 1};
};

} // namespace bayesian_icp::viewer
