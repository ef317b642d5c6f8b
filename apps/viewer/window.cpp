#include "viewer/window.h"

#include "io/errors.h"
#include "io/output_folder.h"

#include <pcl/console/print.h>
#include <pcl/visualization/keyboard_event.h>
#include <pcl/visualization/pcl_visualizer.h>

#include <vtkCamera.h>
#include <vtkPNGWriter.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <cmath>
#include <iostream>

namespace bayesian_icp::viewer {

namespace {

using pcl::visualization::PCLVisualizer;

constexpr const char* title = "pcl_bayesian_icp_viewer";
constexpr double vertical_angle = 0.5236; // 30 degrees, as VTK

/** PCLVisualizer takes -cam, and the clouds' names, from a command line. */
std::shared_ptr<PCLVisualizer>
makeVisualizer(const ViewOptions& options, const std::vector<std::string>& cloud_files)
{
  std::vector<std::string> words = {title};
  words.insert(words.end(), cloud_files.begin(), cloud_files.end());
  if (!options.camera.empty())
    words.insert(words.end(), {"-cam", options.camera});
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  auto count = static_cast<int>(arguments.size());
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  auto window = vtkSmartPointer<vtkRenderWindow>::New();
  window->SetOffScreenRendering(options.isOffScreen());
  auto style = vtkSmartPointer<pcl::visualization::PCLVisualizerInteractorStyle>::New();
  return std::make_shared<PCLVisualizer>(
      count, arguments.data(), renderer, window, title, style, !options.isOffScreen());
}

} // namespace

Window::Window(const ViewOptions& options, const std::vector<std::string>& cloud_files)
: visualizer_(makeVisualizer(options, cloud_files))
, is_off_screen_(options.isOffScreen())
{
  has_users_camera_ = visualizer_->cameraParamsSet() || visualizer_->cameraFileLoaded();
  if (!options.camera.empty() && !has_users_camera_)
    throw io::UsageError("-cam: " + io::inQuotes(options.camera) +
                         " is neither a camera as key c prints it nor a .cam file");
  if (!has_users_camera_ || options.is_size_given)
    visualizer_->getRenderWindow()->SetSize(options.width, options.height);
  visualizer_->setShowFPS(false);
  visualizer_->setBackgroundColor(
      options.background[0], options.background[1], options.background[2]);
}

std::vector<int>
Window::makePanels(std::size_t number)
{
  visualizer_->removeAllPointClouds();
  visualizer_->removeAllShapes();
  if (number == 1)
    return {0};
  double background[3];
  visualizer_->getRendererCollection()->GetFirstRenderer()->GetBackground(background);
  const auto columns = static_cast<int>(std::ceil(std::sqrt(double(number))));
  const int rows = (static_cast<int>(number) + columns - 1) / columns;
  grid_ = {columns, rows};
  std::vector<int> viewports;
  for (int i = 0; i < static_cast<int>(number); ++i) {
    const double x = double(i % columns) / columns;
    const double y = double(rows - 1 - i / columns) / rows;
    int viewport = 0;
    visualizer_->createViewPort(x, y, x + 1.0 / columns, y + 1.0 / rows, viewport);
    visualizer_->setBackgroundColor(
        background[0], background[1], background[2], viewport);
    viewports.push_back(viewport);
  }
  return viewports;
}

Eigen::Vector2i
Window::panelSize() const
{
  const int* size = visualizer_->getRenderWindow()->GetSize();
  return {size[0] / grid_[0], size[1] / grid_[1]};
}

void
Window::lookAt(const Eigen::Matrix3Xd& points,
               const ViewDirection& view,
               const PictureArea& area)
{
  if (has_users_camera_ || points.cols() == 0)
    return;
  const Eigen::Vector2d size = panelSize().cast<double>();
  const CameraPose camera =
      fitCamera(points, view, vertical_angle, size[0] / size[1], area);
  visualizer_->setCameraFieldOfView(vertical_angle);
  visualizer_->setCameraPosition(camera.position.x(),
                                 camera.position.y(),
                                 camera.position.z(),
                                 camera.focal_point.x(),
                                 camera.focal_point.y(),
                                 camera.focal_point.z(),
                                 camera.up.x(),
                                 camera.up.y(),
                                 camera.up.z());
}

void
Window::toggle(const std::string& prefix)
{
  const auto toggleIf = [&prefix](const std::string& name, vtkProp& prop) {
    if (name.rfind(prefix, 0) == 0)
      prop.SetVisibility(!prop.GetVisibility());
  };
  for (auto& [name, cloud] : *visualizer_->getCloudActorMap())
    toggleIf(name, *cloud.actor);
  for (auto& [name, shape] : *visualizer_->getShapeActorMap())
    toggleIf(name, *shape);
}

void
Window::handleKeys()
{
  pcl::console::setVerbosityLevel(pcl::console::L_INFO);
  visualizer_->registerKeyboardCallback(
      [this](const pcl::visualization::KeyboardEvent& event) {
        if (!event.keyDown() || event.isCtrlPressed() || event.isAltPressed())
          return;
        const unsigned char key = event.getKeyCode();
        if (key == 'h' || key == 'H')
          std::cout << keysText() << std::flush;
        if (key == 'k')
          toggle("legend");
        for (const LayerName& name : layer_names)
          if (key == static_cast<unsigned char>(name.key))
            toggle(std::string(name.name) + "/");
      });
}

void
Window::spinOnce(int milliseconds)
{
  visualizer_->spinOnce(milliseconds, true);
}

bool
Window::isClosed() const
{
  // Without a window PCL says that it was stopped.
  return !is_off_screen_ && visualizer_->wasStopped();
}

void
Window::save(const std::string& name, io::OutputFolder& folder)
{
  visualizer_->getRenderWindow()->Render();
  auto picture = vtkSmartPointer<vtkWindowToImageFilter>::New();
  picture->SetInput(visualizer_->getRenderWindow());
  picture->SetInputBufferTypeToRGB();
  picture->ReadFrontBufferOff();
  auto writer = vtkSmartPointer<vtkPNGWriter>::New();
  writer->SetInputConnection(picture->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  folder.add(name, [bytes](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(bytes->GetPointer(0)),
                 bytes->GetNumberOfValues());
  });
  folder.commit();
}

} // namespace bayesian_icp::viewer
