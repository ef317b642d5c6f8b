#include "report/verdict.h"

#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/report_text.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::app {

namespace {

/** Digits of means whose standard deviation is not known, or zero. */
constexpr int default_decimals = 4;

/** No line breaks within a coordinate. */
const std::string space = "\u00A0";
const std::string plus_minus = space + "±" + space;
const std::string degree = "°";

/** Decimals that show a deviation with two significant digits. */
int
decimalsFor(double deviation)
{
  if (!(deviation > 0.0) || !std::isfinite(deviation))
    return default_decimals;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(deviation))), 0, 9);
}

std::string
roundedTo(double value, int decimals)
{
  const std::string text = io::fixedTextOf(value, decimals);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

/** "± 0.42 mm" */
std::string
deviationText(double deviation, bool is_angle)
{
  if (!std::isfinite(deviation))
    return plus_minus + "unknown";
  const LengthUnit unit = unitFor(deviation);
  const double shown = is_angle ? deviation : unit.per_metre * deviation;
  return plus_minus + roundedTo(shown, deviation > 0.0 ? decimalsFor(shown) : 0) +
         (is_angle ? degree : space + unit.name);
}

std::string
poseText(const Vector6d& mean, const Vector6d& standard_deviations)
{
  std::string text;
  for (int k = 0; k < 6; ++k)
    text += (k > 0 ? ", " : "") + uncertainText(k, mean[k], standard_deviations[k]);
  return text;
}

std::string
poseText(const Summary& summary)
{
  Vector6d standard_deviations;
  for (int k = 0; k < 6; ++k)
    standard_deviations[k] =
        summary.coordinates[static_cast<std::size_t>(k)].standard_deviation;
  return poseText(meanPoseCoordinates(summary), standard_deviations);
}

std::string
weightText(double weight)
{
  constexpr double least = 0.01;
  return weight < least ? "below 0.01" : "about " + io::fixedTextOf(weight, 2);
}

std::string
modesText(const std::vector<Mode>& modes)
{
  std::string text;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Mode& mode = modes[i];
    text +=
        (i > 0 ? "; or " : "") + std::string("pose ") + io::textOf(i + 1) +
        " (weight " + weightText(mode.weight) + "): " +
        poseText(
            mode.mean,
            mode.covariance(CovarianceConvention::Parameters).diagonal().cwiseSqrt());
  }
  return text;
}

/** "; along these motions the clouds say nothing: ..." */
std::string
motionsText(const DataReport& data, Observability observability, const char* meaning)
{
  std::string text;
  for (const DataDirection& direction : data.directions)
    if (direction.observability == observability)
      text += (text.empty() ? "" : ", ") + direction.description;
  return text.empty() ? "" : std::string("; ") + meaning + ": " + text;
}

std::string
dataVerdict(const DataReport& data)
{
  if (!data.is_available)
    return "";
  std::string text = motionsText(data,
                                 Observability::PriorOnly,
                                 "not observable in these clouds, held by the prior "
                                 "alone") +
                     motionsText(data, Observability::Weak, "hardly observable");
  const std::string flags = flagNames(data.flags);
  return text + (flags.empty() ? "" : "; flags: " + flags);
}

std::string
divergedText(const Summary& summary)
{
  return io::textOf(summary.num_diverged_chains) + " of " +
         io::textOf(summary.num_chains) + " chains";
}

Verdict
goodOpening(const DataReport& data, Preset preset)
{
  using html::Tone;
  if (preset != Preset::Calibrated)
    return {Tone::Good, "Good draws of the posterior that was stated"};
  const auto num_unobserved =
      std::count_if(data.directions.begin(),
                    data.directions.end(),
                    [](const DataDirection& direction) {
                      return direction.observability != Observability::Observed;
                    });
  if (num_unobserved > 0)
    return {Tone::Caution,
            "Reliable, but " + io::textOf(num_unobserved) +
                " of 6 motions cannot be observed well"};
  return {Tone::Good, "The pose and its ± can be relied on"};
}

/** Tone, heading, and what the sentence begins with. */
Verdict
opening(const Summary& summary, Preset preset)
{
  using html::Tone;
  switch (summary.status) {
  case Status::Ok:
    return goodOpening(summary.data, preset);
  case Status::Doubtful:
    return {Tone::Caution, "Use with care: the result is doubtful"};
  case Status::NotMixed:
    return {Tone::Bad,
            // Particles have no R-hat, nor have chains of a few draws.
            std::isnan(summary.coordinates[0].rhat)
                ? "Do not trust the ±: the draws have not converged"
                : "Do not trust the ±: the chains have not mixed",
            "Draws so far, which describe the chains rather than the posterior: "};
  case Status::SeveralModes:
    return {Tone::Bad,
            "Do not use one mean: " + io::textOf(summary.modes.size()) +
                " different poses fit"};
  case Status::Diverged:
    return {Tone::Bad,
            "Do not trust this posterior: " + divergedText(summary) + " diverged",
            "Draws of the others: "};
  case Status::Cancelled:
    return {Tone::Bad,
            "Interrupted: do not trust the ±",
            "Draws until then (" + io::textOf(summary.num_draws) + "): "};
  default:
    return {Tone::Bad, "There is no posterior"};
  }
}

} // namespace

std::string
uncertainText(int coordinate, double mean, double standard_deviation)
{
  const bool is_angle = isAngle(coordinate);
  const double factor = is_angle ? degrees_per_radian : 1.0;
  const double deviation = factor * standard_deviation;
  const std::string name = coordinate_names[coordinate];
  if (!std::isfinite(mean))
    return name + space + "unknown";
  return name + space + roundedTo(factor * mean, decimalsFor(deviation)) +
         (is_angle ? degree : space + "m") + deviationText(deviation, is_angle);
}

Verdict
verdictOf(const Summary& summary, Preset preset)
{
  Verdict verdict = opening(summary, preset);
  if (summary.num_draws == 0) {
    verdict.sentence += summary.message + '.';
    return verdict;
  }
  const bool has_modes =
      summary.status == Status::SeveralModes && !summary.modes.empty();
  verdict.sentence += (has_modes ? modesText(summary.modes) : poseText(summary)) +
                      dataVerdict(summary.data) + '.';
  verdict.scale_note = scaleNote(preset);
  return verdict;
}

} // namespace bayesian_icp::app
