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
