#include "io/coordinates.h"
#include "viewer/window.h"

#include <pcl/visualization/pcl_visualizer.h>

#include <vtkLookupTable.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>

namespace bayesian_icp::viewer {

int
Window::fontSize() const
{
  const Eigen::Vector2i size = panelSize();
  return std::clamp(std::min(size.x() / 64, size.y() / 48), 11, 40);
}

int
Window::lineHeight() const
{
  return 3 * fontSize() / 2;
}

int
Window::barWidth() const
{
  return 8 * fontSize();
}

std::size_t
Window::lineWidth(bool has_color_bar) const
{
  const int margins = 2 * fontSize() + (has_color_bar ? barWidth() : 0);
  return static_cast<std::size_t>((panelSize().x() - margins) / (0.55 * fontSize()));
}

bool
Window::hasRoomFor(std::size_t num_lines) const
{
  return 3 * (static_cast<int>(num_lines) + 2) * lineHeight() <= 2 * panelSize().y();
}

PictureArea
Window::areaBeside(std::size_t num_legend_lines,
                   std::size_t num_status_lines,
                   bool has_color_bar) const
{
  const Eigen::Vector2i size = panelSize();
  const auto shareOf = [&](std::size_t num_lines) {
    return 2.0 * lineHeight() * (static_cast<double>(num_lines) + 1.0) / size.y();
  };
  PictureArea area;
  area.top = 1.0 - shareOf(num_legend_lines);
  area.bottom = std::min(-1.0 + shareOf(num_status_lines), 0.0);
  area.right = has_color_bar ? 1.0 - 2.0 * barWidth() / size.x() : 0.95;
  area.left = -0.95;
  return area;
}

void
Window::write(const std::vector<LegendLine>& lines,
              int y,
              const std::string& prefix,
              int viewport)
{
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto [red, green, blue] = lines[i].color;
    visualizer_->addText(lines[i].text,
                         fontSize(),
                         y,
                         fontSize(),
                         red,
                         green,
                         blue,
                         prefix + std::to_string(i),
                         viewport);
    y -= lineHeight();
  }
}

void
Window::addLegend(const std::vector<LegendLine>& lines, int viewport)
{
  write(lines,
        panelSize().y() - 2 * fontSize(),
        "legend/" + std::to_string(viewport) + "/",
        viewport);
}

void
Window::addStatus(const std::vector<LegendLine>& lines, int viewport)
{
  const int lines_above = static_cast<int>(lines.size()) - 1;
  write(lines, fontSize() + lines_above * lineHeight(), "status/", viewport);
}

void
Window::addActor(vtkActor2D* actor, const std::string& id, int viewport)
{
  auto* renderers = visualizer_->getRendererCollection().Get();
  vtkRenderer::SafeDownCast(renderers->GetItemAsObject(viewport))->AddActor2D(actor);
  (*visualizer_->getShapeActorMap())[id] = actor;
}

void
Window::addAxisName(std::size_t axis,
                    const Eigen::Vector3d& end,
                    const Color& color,
                    const std::string& id,
                    int viewport)
{
  auto name = vtkSmartPointer<vtkTextActor>::New();
  name->SetInput(std::string(1, "xyz"[axis]).c_str());
  name->GetPositionCoordinate()->SetCoordinateSystemToWorld();
  name->GetPositionCoordinate()->SetValue(end.x(), end.y(), end.z());
  vtkTextProperty& text = *name->GetTextProperty();
  text.SetColor(color[0], color[1], color[2]);
  text.SetFontSize(lineHeight());
  text.BoldOn();
  text.ShadowOn();
  text.SetJustificationToCentered();
  text.SetVerticalJustificationToCentered();
  addActor(name, id + "/name", viewport);
}

void
Window::addColorBar(double maximum, const Color& text_color, int viewport)
{
  const app::LengthUnit unit = app::unitFor(maximum);
  auto colors = vtkSmartPointer<vtkLookupTable>::New();
  pcl::visualization::getColormapLUT(pcl::visualization::PCL_VISUALIZER_LUT_VIRIDIS,
                                     colors);
  colors->SetTableRange(0.0, unit.per_metre * maximum);
  auto bar = vtkSmartPointer<vtkScalarBarActor>::New();
  bar->SetLookupTable(colors);
  bar->SetTitle((std::string("sd [") + unit.name + "]").c_str());
  bar->SetNumberOfLabels(6);
  bar->SetLabelFormat("%-#.3g");
  const double width = double(barWidth()) / panelSize().x();
  bar->SetPosition(1.0 - width, 0.25);
  bar->SetWidth(0.75 * width);
  bar->SetHeight(0.5);
  bar->UnconstrainedFontSizeOn();
  for (vtkTextProperty* text :
       {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    text->SetColor(text_color[0], text_color[1], text_color[2]);
    text->SetFontSize(fontSize());
    text->ItalicOff();
    text->ShadowOff();
  }
  addActor(bar, "legend/bar/" + std::to_string(viewport), viewport);
}

} // namespace bayesian_icp::viewer
