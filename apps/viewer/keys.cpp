#include "viewer/keys.h"

#include "viewer/view_options.h"
#include "viewer/window.h"

#include <pcl/console/print.h>
#include <pcl/visualization/keyboard_event.h>
#include <pcl/visualization/pcl_visualizer.h>

#include <iostream>
#include <sstream>

namespace bayesian_icp::viewer {

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
  window.visualizer().registerKeyboardCallback(
      [&window](const pcl::visualization::KeyboardEvent& event) {
        if (!event.keyDown() || event.isCtrlPressed() || event.isAltPressed())
          return;
        const unsigned char key = event.getKeyCode();
        if (key == 'h' || key == 'H')
          std::cout << keysText() << std::flush;
        if (key == 'k')
          window.toggle("legend");
        for (const LayerName& name : layer_names)
          if (key == static_cast<unsigned char>(name.key))
            window.toggle(std::string(name.name) + "/");
      });
}

} // namespace bayesian_icp::viewer
