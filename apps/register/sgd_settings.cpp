#include "register/sgd_settings.h"

#include "register/field_options.h"
#include "register/json_values.h"

#include <set>
#include <sstream>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

constexpr const char* group = "options";

// clang-format off
/** Calls visit(field, value) for what only SGD-ICP has. */
template <typename OptionsT, typename Visitor>
void
visitOwnFields(OptionsT& options, Visitor&& visit)
{
  visit({group, "optimizer", "optimizer", "NAME",
         "Optimizer that turns gradients into steps."}, options.optimizer);
  visit({group, "translation_epsilon_m", "translation-epsilon", "M",
         "The pose is at rest while its translation stays within this distance of "
         "where it came to rest [m]. 0 means never."}, options.translation_epsilon);
  visit({group, "rotation_epsilon_rad", "rotation-epsilon", "RAD",
         "The pose is at rest only while the sum of the changes of its angles is below "
         "this [rad]."}, options.rotation_epsilon);
  visit({group, "still_iterations", "still-iterations", "N",
         "Number of consecutive steps at rest after which the descent has converged."},
        options.num_still_iterations);
  visit({group, "is_one_to_one", "keep-duplicates", "",
         "Let a target point be in several pairs of a mini-batch. Without it, only the "
         "pair with the nearest source point counts."}, options.is_one_to_one);
}

/** As visitOwnFields(), for what Bayesian ICP has, too. */
template <typename SettingsT, typename Visitor>
void
visitSharedFields(SettingsT& settings, Visitor&& visit)
{
  auto& options = settings.options;
  visit({group, "step_size", "step-size", "", ""}, options.step_size);
  visit({group, "batch_size", "batch-size", "", ""}, options.batch_size);
  visit({group, "max_iterations", "iterations", "", ""}, options.max_iterations);
  visit({group, "max_distance_m", "max-distance", "", ""}, settings.max_distance);
  visit({group, "seed", "seed", "", ""}, options.seed);
  visit({group, "guess_matrix", "guess", "", ""}, settings.guess);
}
// clang-format on

template <typename SettingsT, typename Visitor>
void
visitSgdFields(SettingsT& settings, Visitor&& visit)
{
  visitOwnFields(settings.options, visit);
  visitSharedFields(settings, visit);
}

void
refuseOptionsOfThePosterior(const po::variables_map& given)
{
  std::set<std::string> known = {"method", "output", "json", "quiet", "cloud"};
  const SgdSettings settings;
  visitSgdFields(settings, [&known](const Field& field, const auto&) {
    known.insert(longNameOf(field));
  });
  for (const auto& option : given)
    if (known.count(option.first) == 0)
      throw io::UsageError("--" + option.first + ": has no effect with method sgd-icp");
}

void
check(const SgdSettings& settings, bool has_step_size)
{
  const StochasticGradientIcpOptions& options = settings.options;
  if (!(settings.max_distance > 0.0))
    throw io::UsageError("--max-distance: is " + io::textOf(settings.max_distance) +
                         ", but must be positive (m)");
  if (has_step_size && options.optimizer == SgdOptimizer::AdaDelta)
    throw io::UsageError("--step-size: has no effect with optimizer adadelta");
  if (has_step_size && std::isnan(options.step_size))
    throw io::UsageError("--step-size: is nan, but must be positive and finite");
  const std::string complaint = options.validate();
  if (!complaint.empty())
    throw io::UsageError(complaintWithOption(
        complaint, [&](const auto& visitor) { visitSgdFields(settings, visitor); }));
}

} // namespace

po::options_description
describeSgdOptions()
{
  po::options_description options("Method sgd-icp only");
  const StochasticGradientIcpOptions defaults;
  visitOwnFields(defaults, Describer{options});
  return options;
}

SgdSettings
sgdSettingsFrom(const po::variables_map& given)
{
  refuseOptionsOfThePosterior(given);
  SgdSettings settings;
  visitSgdFields(settings, OptionReader{given});
  settings.options.is_one_to_one = given.count("keep-duplicates") == 0;
  check(settings, given.count("step-size") > 0);
  if (std::isnan(settings.options.step_size))
    settings.options.step_size = defaultStepSize(settings.options.optimizer);
  return settings;
}

nlohmann::ordered_json
jsonOf(const SgdSettings& settings)
{
  FieldWriter writer;
  visitSgdFields(settings, writer);
  return writer.document[group];
}

std::string
aboutSgdIcp()
{
  const StochasticGradientIcpOptions defaults;
  std::ostringstream text;
  text << R"(
Method sgd-icp finds a pose by stochastic gradient descent, but no posterior.
Of the options above it uses --guess, --max-distance, --seed, --json, --quiet
and --output (aligned.pcd and sgd_icp.json). It also uses, with defaults of its
own, --iterations ()"
       << defaults.max_iterations << "), --batch-size (" << defaults.batch_size
       << ") and --step-size\n(";
  for (const SgdOptimizer optimizer : choicesOf(SgdOptimizer()))
    if (optimizer != SgdOptimizer::AdaDelta)
      text << toString(optimizer) << ' ' << defaultStepSize(optimizer)
           << (optimizer == SgdOptimizer::RmsProp ? "; adadelta has none" : ", ");
  text << R"(). Other
options are errors. The exit code is 0 if the descent came to rest, else 1. If
no step was made, only sgd_icp.json is written, and an older aligned.pcd is
removed.
)";
  return text.str();
}

} // namespace bayesian_icp::app
