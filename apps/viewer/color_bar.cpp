#include "viewer/color_bar.h"

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

constexpr int num_colors = 256;

vtkSmartPointer<vtkLookupTable>
tableUpTo(double maximum)
{
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(num_colors);
  table->SetTableRange(0.0, maximum);
  for (int i = 0; i < num_colors; ++i) {
    const Color color = mapColor(double(i) / (num_colors - 1));
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  return table;
}

} // namespace

void
addColorBar(double maximum, const Color& text_color, int viewport, Window& window)
{
  const LengthUnit unit = unitFor(maximum);
  auto bar = vtkSmartPointer<vtkScalarBarActor>::New();
  bar->SetLookupTable(tableUpTo(maximum / unit.in_metres));
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
