#include "viewer/view_options.h"

namespace bayesian_icp::viewer {

namespace {

const std::vector<Panel>&
panelsOfMultiview()
{
  static const std::vector<Panel> panels = {
      {"before", {Layer::Source, Layer::Target}},
      {"after", {Layer::Target, Layer::Aligned}},
      {"which poses are likely?",
       {Layer::Target, Layer::Draws, Layer::Position, Layer::Rotation}},
      {"how far off may each point be?", {Layer::Target, Layer::Deviation}}};
  return panels;
}

void
leaveOutDraws(Layers& layers)
{
  const std::size_t size_before = layers.size();
  layers.erase(layers.lower_bound(Layer::Deviation), layers.end());
  if (layers.size() < size_before)
    layers.insert(Layer::Aligned);
}

} // namespace

std::string
keysText()
{
  std::string text = "Keys in addition to those of pcl_viewer (h lists all):\n";
  for (const LayerName& name : layer_names)
    text += std::string("  ") + name.key + "    " + name.name + " on/off\n";
  return text + "  k    legend and colour bar on/off\n";
}

std::vector<Panel>
ViewOptions::panels(bool has_draws) const
{
  std::vector<Panel> panels =
      is_multiview ? panelsOfMultiview() : std::vector<Panel>{{"", layers}};
  if (!has_draws)
    for (Panel& panel : panels)
      leaveOutDraws(panel.layers);
  return panels;
}

} // namespace bayesian_icp::viewer
