#include "register/data_text.h"

#include "io/numbers.h"
#include "register/text_layout.h"

#include <algorithm>
#include <limits>

namespace bayesian_icp::app {

namespace {

constexpr double millimetres = 1e3;
constexpr double milliradians = 1e3;
constexpr double percent = 100.0;
constexpr std::size_t column_width = 11;
/** Of the column "held by". */
constexpr std::size_t holder_width = 7;

/** Deviations as displacement, and as angle where the motion is not a translation. */
std::string
directionRow(const DataDirection& direction)
{
  return cell(millimetres * direction.standard_deviation, 3, column_width) +
         cell(milliradians * angularDeviation(direction), 3, column_width) +
         cell(millimetres * direction.prior_standard_deviation, 1, column_width) +
         "  " + leftAligned(holderOf(direction.observability), holder_width) + "  " +
         direction.description + '\n';
}

} // namespace

std::string
flagNames(const DataFlags& flags)
{
  std::string names;
  for (const DataFlag& flag : data_flags)
    if (flags.*flag.is_raised)
      names += (names.empty() ? "" : ", ") + std::string(flag.key);
  std::replace(names.begin(), names.end(), '_', ' ');
  return names;
}

const char*
holderOf(Observability observability)
{
  return observability == Observability::Observed ? "data"
         : observability == Observability::Weak   ? "weak"
                                                  : "prior";
}

double
angularDeviation(const DataDirection& direction)
{
  const bool is_translation = direction.description.rfind("translation", 0) == 0;
  return is_translation
             ? std::numeric_limits<double>::quiet_NaN()
             : direction.standard_deviation * direction.twist.tail<3>().norm();
}

std::string
dataText(const DataReport& report)
{
  if (!report.is_available)
    return "";
  std::string text = "\nHow well the clouds hold the pose, best known first (root mean "
                     "square displacement of\nthe source's points, and angle):\n";
  for (const char* title : {"sd [mm]", "sd [mrad]", "prior [mm]"})
    text += rightAligned(title, column_width);
  text += "  held by  motion\n";
  for (const DataDirection& direction : report.directions)
    text += directionRow(direction);
  const std::string flags = flagNames(report.flags);
  return text + "Noise:   " + io::textOf(millimetres * report.noise_scale, 4) +
         " mm from the surface, " + io::fixedTextOf(report.residual_scale, 2) +
         " times the target's own\nPatches: about " +
         io::fixedTextOf(report.effective_patches, 0) +
         " independent ones, correlation factor " +
         io::fixedTextOf(report.correlation_factor, 2) +
         "\nSupport: " + io::fixedTextOf(percent * report.active_fraction, 0) +
         " % of the source points lie on the target's surface\nFlags:   " +
         (flags.empty() ? "none" : flags) + '\n';
}

} // namespace bayesian_icp::app
