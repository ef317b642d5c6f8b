#include "viewer/annotations.h"

#include "io/coordinates.h"

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

namespace {

/** Of text in a panel [pixels]. */
int
fontSizeIn(const Window& window)
{
  const Eigen::Vector2i size = window.panelSize();
  return std::clamp(std::min(size.x() / 64, size.y() / 48), 11, 40);
}

/** From one line of text to the next [pixels]. */
int
lineHeightIn(const Window& window)
{
  return 3 * fontSizeIn(window) / 2;
}

/** Of a colour bar with its numbers [pixels]. */
int
barWidthIn(const Window& window)
{
  return 8 * fontSizeIn(window);
}

/** Writes at the left of a panel, the first line \p y pixels above its lower edge,
 * under names that begin with \p prefix. */
void
write(const std::vector<LegendLine>& lines,
      int y,
      const std::string& prefix,
      int viewport,
      Window& window)
{
  const int font_size = fontSizeIn(window);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto [red, green, blue] = lines[i].color;
    window.visualizer().addText(lines[i].text,
                                font_size,
                                y,
                                font_size,
                                red,
                                green,
                                blue,
                                prefix + std::to_string(i),
                                viewport);
    y -= lineHeightIn(window);
  }
}

void
addActor(vtkActor2D* actor, const std::string& id, int viewport, Window& window)
{
  auto& visualizer = window.visualizer();
  auto* renderers = visualizer.getRendererCollection().Get();
  vtkRenderer::SafeDownCast(renderers->GetItemAsObject(viewport))->AddActor2D(actor);
  (*visualizer.getShapeActorMap())[id] = actor;
}

} // namespace

std::size_t
lineWidth(bool has_color_bar, const Window& window)
{
  const int font_size = fontSizeIn(window);
  const int margins = 2 * font_size + (has_color_bar ? barWidthIn(window) : 0);
  return static_cast<std::size_t>((window.panelSize().x() - margins) /
                                  (0.55 * font_size));
}

bool
hasRoomFor(std::size_t num_lines, const Window& window)
{
  return 3 * (static_cast<int>(num_lines) + 2) * lineHeightIn(window) <=
         2 * window.panelSize().y();
}

PictureArea
areaBeside(std::size_t num_legend_lines,
           std::size_t num_status_lines,
           bool has_color_bar,
           const Window& window)
{
  const Eigen::Vector2i size = window.panelSize();
  const auto shareOf = [&](std::size_t num_lines) {
    return 2.0 * lineHeightIn(window) * (static_cast<double>(num_lines) + 1.0) /
           size.y();
  };
  PictureArea area;
  area.top = 1.0 - shareOf(num_legend_lines);
  area.bottom = std::min(-1.0 + shareOf(num_status_lines), 0.0);
  area.right = has_color_bar ? 1.0 - 2.0 * barWidthIn(window) / size.x() : 0.95;
  area.left = -0.95;
  return area;
}

void
addLegend(const std::vector<LegendLine>& lines, int viewport, Window& window)
{
  write(lines,
        window.panelSize().y() - 2 * fontSizeIn(window),
        "legend/" + std::to_string(viewport) + "/",
        viewport,
        window);
}

void
addStatus(const std::vector<LegendLine>& lines, int viewport, Window& window)
{
  const int lines_above = static_cast<int>(lines.size()) - 1;
  write(lines,
        fontSizeIn(window) + lines_above * lineHeightIn(window),
        "status/",
        viewport,
        window);
}

void
addAxisName(std::size_t axis,
            const Eigen::Vector3d& end,
            const Color& color,
            const std::string& id,
            int viewport,
            Window& window)
{
  auto name = vtkSmartPointer<vtkTextActor>::New();
  name->SetInput(std::string(1, "xyz"[axis]).c_str());
  name->GetPositionCoordinate()->SetCoordinateSystemToWorld();
  name->GetPositionCoordinate()->SetValue(end.x(), end.y(), end.z());
  vtkTextProperty& text = *name->GetTextProperty();
  text.SetColor(color[0], color[1], color[2]);
  text.SetFontSize(lineHeightIn(window));
  text.BoldOn();
  text.ShadowOn();
  text.SetJustificationToCentered();
  text.SetVerticalJustificationToCentered();
  addActor(name, id + "/name", viewport, window);
}

void
addColorBar(double maximum, const Color& text_color, int viewport, Window& window)
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
  const double width = double(barWidthIn(window)) / window.panelSize().x();
  bar->SetPosition(1.0 - width, 0.25);
  bar->SetWidth(0.75 * width);
  bar->SetHeight(0.5);
  bar->UnconstrainedFontSizeOn();
  for (vtkTextProperty* text :
       {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    text->SetColor(text_color[0], text_color[1], text_color[2]);
    text->SetFontSize(fontSizeIn(window));
    text->ItalicOff();
    text->ShadowOff();
  }
  addActor(bar, "legend/bar/" + std::to_string(viewport), viewport, window);
}

} // namespace bayesian_icp::viewer
