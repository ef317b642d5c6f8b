#include "register/settings.h"

#include "io/numbers.h"
#include "register/setting_fields.h"

#include <cmath>

namespace bayesian_icp::app {

namespace {

/** Finds the command line option of the first field that a complaint of
 * Options::validate() may speak of. */
struct OptionFinder {
  std::string complaint;
  std::string option;

  template <typename T>
  void
  operator()(const Field& field, const T&)
  {
    const std::string key = field.key;
    const std::string name = nameInComplaint();
    const bool names_group = complaint.find('.') < complaint.find(' ');
    const bool is_in_group =
        !names_group || complaint.rfind(std::string(field.group) + '.', 0) == 0;
    // Keys of a configuration file may end in a unit.
    if (option.empty() && is_in_group &&
        (key == name || key.rfind(name + "_m", 0) == 0 ||
         key.rfind(name + "_rad", 0) == 0))
      option = "--" + longNameOf(field);
  }

  /** "prior.variance[x] is ..." speaks of "variance". */
  std::string
  nameInComplaint() const
  {
    const std::string path = complaint.substr(0, complaint.find_first_of(" ["));
    return path.substr(path.find('.') == std::string::npos ? 0 : path.find('.') + 1);
  }
};

std::string
withOptionName(const Settings& settings, const std::string& complaint)
{
  if (complaint.empty())
    return complaint;
  OptionFinder finder{complaint, ""};
  visitSettings(settings, finder);
  return finder.option.empty() ? complaint : finder.option + ": " + complaint;
}

/** Normals are found by the search of preset `exact`, which has no pairs to filter. */
bool
lacksNormals(const Settings& settings)
{
  return settings.options.preset == Preset::Exact &&
         settings.options.exact.residual.residual == Residual::PointToPlane &&
         (settings.is_reciprocal || settings.is_one_to_one);
}

} // namespace

void
Settings::scaleLengths(double factor)
{
  guess.topRightCorner<3, 1>() *= factor;
  max_distance *= factor;
  options.prior.mean.head<3>() *= factor;
  options.prior.variance.head<3>() *= factor * factor;
  options.chains.initial_spread.head<3>() *= factor;
}

void
Settings::scaleToClouds(std::size_t num_points, double largest_coordinate)
{
  if (are_lengths_scaled)
    scaleLengths(largest_coordinate);
  are_lengths_scaled = false;
  const auto size = static_cast<double>(num_points);
  if (is_step_size_times_points)
    options.sgld.step_size /= size;
  if (is_effective_points_source_size)
    options.likelihood.effective_points = size;
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
    return "--residual: is point-to-plane, but must be point-to-point with "
           "--reciprocal "
           "or --one-to-one";
  return withOptionName(*this, options.validate());
}

} // namespace bayesian_icp::app
