#include "viewer/option_values.h"

#include "io/errors.h"
#include "io/numbers.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

[[noreturn]] void
refuse(const std::string& option, const std::string& text, const std::string& expected)
{
  throw io::UsageError(option + ": " + io::quoted(text) + " is not " + expected);
}

template <typename Number>
bool
readBetween(std::string_view text, Number lowest, Number highest, Number& value)
{
  return io::readNumber(text, value) && value >= lowest && value <= highest;
}

} // namespace

Color
readColor(const std::string& option, const std::string& text)
{
  const auto items = io::splitAt(',', text);
  Color color{};
  bool is_good = items.size() == 3;
  for (std::size_t k = 0; is_good && k < 3; ++k)
    is_good = readBetween(items[k], 0.0, 255.0, color[k]);
  if (!is_good)
    refuse("-" + option, text, "a colour r,g,b, each 0 to 1 or each 0 to 255");
  if (*std::max_element(color.begin(), color.end()) > 1.0)
    for (double& part : color)
      part /= 255.0;
  return color;
}

int
readPointSize(const std::string& option, const std::string& text)
{
  int size = 0;
  if (!readBetween(text, 1, 64, size))
    refuse("-" + option, text, "a point size, 1 to 64");
  return size;
}

double
readOpacity(const std::string& option, const std::string& text)
{
  double opacity = 0.0;
  if (!readBetween(text, 0.0, 1.0, opacity))
    refuse("-" + option, text, "an opacity, 0 to 1");
  return opacity;
}

double
readNonNegative(const std::string& option, const std::string& text)
{
  double value = 0.0;
  if (!io::readNumber(text, value) || !std::isfinite(value) || value < 0.0)
    refuse("-" + option, text, "a length [m]");
  return value;
}

bool
readSwitch(const std::string& option, const std::string& text)
{
  if (text != "0" && text != "1")
    refuse("-" + option, text, "0 or 1");
  return text == "1";
}

Layers
readLayers(const std::string& text)
{
  Layers layers;
  std::string known;
  for (const LayerName& name : layer_names)
    known += std::string(name.name) + ", ";
  for (const std::string_view item : io::splitAt(',', text)) {
    const std::size_t size_before = layers.size();
    for (const LayerName& name : layer_names)
      if (item == name.name || item == "all")
        layers.insert(name.layer);
    if (layers.size() == size_before)
      refuse("--show", std::string(item), "(another) one of " + known + "all");
  }
  return layers;
}

int
readNumDraws(const std::string& option, const std::string& text)
{
  int number = 0;
  if (!readBetween(text, 1, 1000, number))
    refuse("--" + option, text, "a number of draws, 1 to 1000");
  return number;
}

double
readMagnification(const std::string& text)
{
  double factor = 0.0;
  if (text == "auto")
    return factor;
  if (!io::readNumber(text, factor) || !std::isfinite(factor) || factor <= 0.0)
    refuse("--magnify", text, "a positive number or auto");
  return factor;
}

Reference
readReference(const std::string& text)
{
  if (text != "centroid" && text != "origin")
    refuse("--reference", text, "centroid or origin");
  return text == "origin" ? Reference::Origin : Reference::Centroid;
}

void
readSize(const std::string& text, int& width, int& height)
{
  const auto items = io::splitAt('x', text);
  if (items.size() != 2 || !readBetween(items[0], 64, 8192, width) ||
      !readBetween(items[1], 64, 8192, height))
    refuse("--size", text, "WIDTHxHEIGHT in pixels, each 64 to 8192");
}

} // namespace bayesian_icp::viewer
