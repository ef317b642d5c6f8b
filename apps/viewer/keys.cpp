#include "viewer/keys.h"

#include "viewer/view_options.h"
#include "viewer/window.h"

#include <pcl/console/print.h>
#include <pcl/visualization/keyboard_event.h>
#include <pcl/visualization/pcl_visualizer.h>

#include <iostream>
#include <memory>
#include <set>
#include <sstream>

namespace bayesian_icp::viewer {

namespace {

/** Switches what has a name that begins so. */
void
toggle(const std::string& prefix, std::set<std::string>& hidden, Window& window)
{
  const bool was_hidden = hidden.erase(prefix) > 0;
  if (!was_hidden)
    hidden.insert(prefix);
  window.setVisible(prefix, was_hidden);
}

} // namespace

std::string
keysText()
{
  std::ostringstream keys;
  keys << "Keys in addition to those of pcl_viewer (h lists all):\n";
  for (const LayerName& name : layer_names)
    keys << "  " << name.key << "    " << name.name << " on/off\n";
  keys << "  k    legend and colour bar on/off\n";
  return keys.str();
}

void
handleKeys(Window& window)
{
  pcl::console::setVerbosityLevel(pcl::console::L_INFO);
  auto hidden = std::make_shared<std::set<std::string>>();
  window.visualizer().registerKeyboardCallback(
      [&window, hidden](const pcl::visualization::KeyboardEvent& event) {
        if (!event.keyDown() || event.isCtrlPressed() || event.isAltPressed())
          return;
        const unsigned char key = event.getKeyCode();
        if (key == 'h' || key == 'H')
          std::cout << keysText() << std::flush;
        if (key == 'k')
          toggle("legend", *hidden, window);
        for (const LayerName& name : layer_names)
          if (key == static_cast<unsigned char>(name.key))
            toggle(std::string(name.name) + "/", *hidden, window);
      });
}

} // namespace bayesian_icp::viewer
