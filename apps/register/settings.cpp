#include "register/settings.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "register/choices.h"
#include "register/setting_fields.h"

namespace bayesian_icp::app {

namespace {

/** Normals are found by the search of preset `exact`, which has no pairs to filter. */
bool
lacksNormals(const Settings& settings)
{
  return settings.options.preset == Preset::Exact &&
         settings.options.exact.residual.residual != Residual::PointToPoint &&
         (settings.is_reciprocal || settings.is_one_to_one);
}

bool
hasSetting(Preset preset, const std::string& name)
{
  const Settings settings;
  bool has_it = false;
  visitPreset(preset, settings, [&](const Field& field, const auto&) {
    has_it |= name == "--" + longNameOf(field) || name == field.group ||
              name == pathOf(field);
  });
  return has_it;
}

} // namespace

void
Settings::scaleLengths(double factor)
{
  guess.topRightCorner<3, 1>() *= factor;
  max_distance *= factor;
  options.prior.mean.head<3>() *= factor;
  options.prior.variance.head<3>() *= factor * factor;
  options.paper.initial_spread.head<3>() *= factor;
}

void
Settings::scaleToClouds(std::size_t num_points, double largest_coordinate)
{
  if (are_lengths_scaled)
    scaleLengths(largest_coordinate);
  are_lengths_scaled = false;
  const auto size = static_cast<double>(num_points);
  if (is_step_size_times_points)
    options.paper.sgld.step_size /= size;
  if (is_effective_points_source_size)
    options.paper.scale.effective_points = size;
  is_step_size_times_points = is_effective_points_source_size = false;
}

std::string
Settings::validate() const
{
  if (!(max_distance > 0.0))
    return "--max-distance: is " + io::textOf(max_distance) +
           ", but must be positive (m)";
  if (icp_iterations < 1)
    return "--iterations: is " + io::textOf(icp_iterations) +
           ", but must be at least 1";
  if (!guess.allFinite())
    return "--guess: must be finite";
  if (lacksNormals(*this))
    return std::string("--residual: is ") + toString(options.exact.residual.residual) +
           ", but must be point-to-point with --reciprocal or --one-to-one";
  const std::string complaint = options.validate();
  return complaint.empty()
             ? ""
             : complaintWithOption(complaint, [this](const auto& visitor) {
                 visitSettings(*this, visitor);
               });
}

void
refuseOfOtherPresets(const std::string& name, Preset preset)
{
  if (hasSetting(preset, name))
    return;
  std::string others;
  for (const Preset candidate : choicesOf(preset))
    if (hasSetting(candidate, name))
      others += (others.empty() ? "" : " and ") + std::string(toString(candidate));
  if (!others.empty())
    throw io::UsageError(name +
                         (others.find(' ') == std::string::npos
                              ? " belongs to preset "
                              : " belongs to presets ") +
                         others + ", and the preset is " + toString(preset));
}

} // namespace bayesian_icp::app
