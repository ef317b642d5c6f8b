#include "viewer/annotations.h"

#include "io/coordinates.h"
#include "io/numbers.h"

#include <pcl/visualization/pcl_visualizer.h>

#include <vtkLookupTable.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkTextProperty.h>

#include <algorithm>

namespace bayesian_icp::viewer {

namespace {

int
fontSizeFor(const Eigen::Vector2i& size)
{
  return std::clamp(size.y() / 48, 11, 40);
}

/** Writes at the left of a panel, \p y pixels above its lower edge. */
void
write(
    const LegendLine& line, int y, const std::string& id, int viewport, Window& window)
{
  const int font_size = fontSizeFor(window.panelSize());
  const auto [red, green, blue] = line.color;
  window.visualizer().addText(
      line.text, font_size, y, font_size, red, green, blue, id, viewport);
}

} // namespace

std::size_t
lineWidth(const Window& window)
{
  const Eigen::Vector2i size = window.panelSize();
  return static_cast<std::size_t>(size.x() / (0.55 * fontSizeFor(size)));
}

PictureArea
areaBeside(std::size_t num_lines, bool has_color_bar, const Window& window)
{
  const Eigen::Vector2i size = window.panelSize();
  const double line = 2.0 * 1.5 * fontSizeFor(size) / size.y();
  PictureArea area;
  area.top = 1.0 - line * (static_cast<double>(num_lines) + 1.0);
  area.bottom = -1.0 + 2.0 * line;
  area.right = has_color_bar ? 0.72 : 0.95;
  area.left = -0.95;
  return area;
}

void
addLegend(const std::vector<LegendLine>& lines, int viewport, Window& window)
{
  const Eigen::Vector2i size = window.panelSize();
  const int font_size = fontSizeFor(size);
  const std::string id = "legend/" + std::to_string(viewport) + "/";
  int y = size.y() - 2 * font_size;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    write(lines[i], y, id + std::to_string(i), viewport, window);
    y -= 3 * font_size / 2;
  }
}

void
addStatus(const LegendLine& status, int viewport, Window& window)
{
  write({io::wrapped(status.text, lineWidth(window)), status.color},
        fontSizeFor(window.panelSize()),
        "status",
        viewport,
        window);
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
  bar->SetPosition(0.86, 0.25);
  bar->SetWidth(0.1);
  bar->SetHeight(0.5);
  bar->UnconstrainedFontSizeOn();
  const int font_size = std::clamp(window.panelSize().y() / 44, 11, 44);
  for (vtkTextProperty* text :
       {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    text->SetColor(text_color[0], text_color[1], text_color[2]);
    text->SetFontSize(font_size);
    text->ItalicOff();
    text->ShadowOff();
  }
  auto& visualizer = window.visualizer();
  auto* renderers = visualizer.getRendererCollection().Get();
  vtkRenderer::SafeDownCast(renderers->GetItemAsObject(viewport))->AddActor2D(bar);
  (*visualizer.getShapeActorMap())["legend/bar/" + std::to_string(viewport)] = bar;
}

} // namespace bayesian_icp::viewer
