#include "register/data_text.h"

#include "io/numbers.h"
#include "register/text_layout.h"

#include <limits>

namespace bayesian_icp::app {

namespace {

constexpr double millimetres = 1e3;
constexpr double milliradians = 1e3;
constexpr double percent = 100.0;
constexpr std::size_t column_width = 11;

/** Who holds the pose along a direction, left aligned below "held by". */
std::string
holderOf(Observability observability)
{
  constexpr std::size_t holder_width = 7;
  const char* name = observability == Observability::Observed ? "data"
                     : observability == Observability::Weak   ? "weak"
                                                              : "prior";
  return "  " + leftAligned(name, holder_width);
}

/** Deviations as displacement, and as angle where the motion is not a translation. */
std::string
directionRow(const DataDirection& direction)
{
  const bool is_translation = direction.description.rfind("translation", 0) == 0;
  const double angle =
      is_translation ? std::numeric_limits<double>::quiet_NaN()
                     : direction.standard_deviation * direction.twist.tail<3>().norm();
  return cell(millimetres * direction.standard_deviation, 3, column_width) +
         cell(milliradians * angle, 3, column_width) +
         cell(millimetres * direction.prior_standard_deviation, 1, column_width) +
         holderOf(direction.observability) + "  " + direction.description + '\n';
}

std::string
flagsLine(const DataFlags& flags)
{
  std::string line;
  const auto add = [&line](bool is_raised, const char* name) {
    if (is_raised)
      line += (line.empty() ? "" : ", ") + std::string(name);
  };
  add(flags.wrong_basin, "wrong basin");
  add(flags.low_support, "low support");
  add(flags.few_patches, "few patches");
  add(flags.misfit, "misfit");
  add(flags.no_information, "no information");
  return "Flags:   " + (line.empty() ? "none" : line) + '\n';
}

} // namespace

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
  return text + "Noise:   " + io::textOf(millimetres * report.noise_scale, 4) +
         " mm from the surface, " + io::fixedTextOf(report.residual_scale, 2) +
         " times the target's own\nPatches: about " +
         io::fixedTextOf(report.effective_patches, 0) +
         " independent ones, correlation factor " +
         io::fixedTextOf(report.correlation_factor, 2) +
         "\nSupport: " + io::fixedTextOf(percent * report.active_fraction, 0) +
         " % of the source points lie on the target's surface\n" +
         flagsLine(report.flags);
}

} // namespace bayesian_icp::app
