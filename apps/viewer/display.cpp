#include "io/errors.h"
#include "viewer/window.h"

#include <X11/Xlib.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace bayesian_icp::viewer {

void
requireDisplay()
{
  // Open to the end of the program: a server such as Xvfb starts over when its last
  // client leaves, and VTK would come in between.
  static Display* const display = XOpenDisplay(nullptr);
  if (display != nullptr)
    return;
  const char* name = std::getenv("DISPLAY");
  const bool is_named = name != nullptr && *name != '\0';
  throw std::runtime_error(
      (is_named ? "the X display " + io::inQuotes(name) + " does not answer"
                : std::string("there is no X display (DISPLAY is not set)")) +
      "; without a screen, run it with xvfb-run -a and --screenshot");
}

} // namespace bayesian_icp::viewer
