#include "register/settings_options.h"

#include "register/config_file.h"
#include "register/field_options.h"
#include "register/setting_fields.h"

#include <optional>

namespace bayesian_icp::app {

namespace po = boost::program_options;

void
describeSettings(po::options_description& options)
{
  const Settings defaults;
  po::options_description registration("Registration");
  registration.add_options()(
      "config",
      po::value<std::string>()->value_name("FILE"),
      "Read settings from a posterior.json, from its 'options' alone, or from a "
      "config.json of the authors' program. Options on the command line take "
      "precedence. Without it, all settings have their defaults.");
  visitRegistration(defaults, Describer{registration});
  po::options_description posterior("Posterior");
  visitPosterior(defaults.options, Describer{posterior});
  visitChains(defaults.options.chains, Describer{posterior});
  options.add(registration).add(posterior);
  for (const Preset preset : choicesOf(Preset())) {
    po::options_description group(std::string("Preset ") + toString(preset));
    visitPreset(preset, defaults, Describer{group});
    options.add(group);
  }
}

Settings
settingsFrom(const po::variables_map& given)
{
  Settings settings;
  std::string config;
  std::optional<Preset> preset;
  po::options_description first;
  first.add_options()("config", io::fileName("", config));
  first.add_options()("preset", io::taken("", [&preset](const std::string& text) {
                        convert("preset", text, preset.emplace());
                      }));
  io::takeOptions(given, first);
  if (!config.empty())
    settings = readConfigFile(config, preset);
  visitSettings(settings, OptionReader{given});
  if (settings.are_lengths_scaled)
    io::refuseOptions(
        given,
        {"guess", "max-distance", "prior-mean", "prior-variance", "initial-spread"},
        ": is in metres, but with normalize-cloud the lengths of " + config +
            " are in units of the clouds");
  if (given.count("step-size") > 0)
    settings.is_step_size_times_points = false;
  if (given.count("effective-points") > 0)
    settings.is_effective_points_source_size = false;
  for (const auto& option : given)
    refuseOfOtherPresets("--" + option.first, settings.options.preset);
  const std::string complaint = settings.validate();
  if (!complaint.empty())
    throw io::UsageError(complaint);
  const auto refuse = [&](bool is_refused,
                          const std::vector<std::string>& names,
                          const std::string& needed) {
    if (is_refused)
      io::refuseOptions(given, names, ": has no effect " + needed);
  };
  const ExactOptions& exact = settings.options.exact;
  refuse(exact.residual.kernel == RobustKernel::None,
         {"kernel-width"},
         "without --kernel");
  refuse(exact.residual.residual != Residual::DistributionToDistribution,
         {"regularization"},
         "without --residual=distribution-to-distribution");
  if (settings.options.preset == Preset::Exact) {
    refuse(!usesParticles(exact.steps), {"particles"}, "without Stein steps (--steps)");
    refuse(usesParticles(exact.steps),
           {"samples", "burn-in", "thinning", "max-step-size"},
           "with Stein steps");
    refuse(exact.steps == ExactSteps::Metropolis,
           {"max-step-size"},
           "with Metropolis steps");
  }
  return settings;
}

} // namespace bayesian_icp::app
