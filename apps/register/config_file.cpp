#include "register/config_file.h"

#include "io/coordinates.h"
#include "io/json_file.h"
#include "io/posterior_file.h"
#include "register/settings_json.h"

#include <bayesian_icp/pose.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace bayesian_icp::app {

namespace {

using io::JsonNode;
using nlohmann::json;

constexpr std::uint64_t max_config_size = 16 << 20;

Settings
settingsWith(const std::optional<Preset>& preset, json settings)
{
  const bool is_object =
      settings.is_object() && settings.value("posterior", json::object()).is_object();
  if (preset && is_object)
    settings["posterior"]["preset"] = toString(*preset);
  return settingsOf(settings);
}

/** The settings of a posterior.json. */
Settings
settingsOfPosterior(const std::optional<Preset>& preset, const json& document)
{
  const json version = document.value("schema_version", json());
  if (document["schema"] != io::posterior_schema_name ||
      version != io::posterior_schema_version)
    throw io::UsageError("unknown schema " + io::inQuotes(document["schema"].dump()) +
                         " version " + io::inQuotes(version.dump()));
  if (!document.contains("options"))
    throw io::UsageError("the key 'options' is missing");
  return settingsWith(preset, document["options"]);
}

/** The keys of the authors' layout; an empty set is a value of its own. */
const std::map<std::string, std::set<std::string>> keys_of_groups = {
    {"normalize-cloud", {}},
    {"method", {}},
    {"initial-guess", {"x", "y", "z", "roll", "pitch", "yaw"}},
    {"prior",
     {"mean-x", "mean-y", "mean-z", "mean-roll", "mean-pitch", "mean-yaw", "variance"}},
    {"icp",
     {"batch-size",
      "max-matching-distance",
      "max-iterations",
      "convergence-steps",
      "translational-convergence",
      "rotational-convergence",
      "filter"}},
    {"fixed", {"step-size"}},
    {"adam", {"step-size", "decay-rate-a", "decay-rate-b"}},
    {"adadelta", {"decay-rate", "preconditioner"}},
    {"momentum", {"step-size"}},
    {"rmsprop", {"step-size", "decay-rate"}},
    {"preconditioned_sgld", {"step-size", "adjust_noise", "decay-rate"}},
    {"preconditioned_sgld2", {"step-size", "adjust_noise", "decay-rate"}}};

/** The program reads true and false, 1 and 0. */
bool
flagOf(const JsonNode& value)
{
  if (value.json().is_boolean())
    return value.json().get<bool>();
  if (value.json() != 0 && value.json() != 1)
    value.refuse("true or false");
  return value.json() == 1;
}

void
checkKeys(const JsonNode& document)
{
  std::set<std::string> groups;
  for (const auto& [name, keys] : keys_of_groups) {
    groups.insert(name);
    if (keys.empty() || !document.has(name))
      continue;
    document[name].requireKeysAmong(keys);
    for (const std::string& key : keys)
      if (key != "filter" && document[name].has(key))
        document[name][key].number();
  }
  document.requireKeysAmong(groups);
}

int
countOf(const JsonNode& value)
{
  const double number = value.number();
  if (number != std::floor(number) || number < 1 ||
      number > std::numeric_limits<int>::max())
    value.refuse("a positive whole number");
  return static_cast<int>(number);
}

Vector6d
poseOf(const JsonNode& group, const std::string& prefix)
{
  Vector6d pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[static_cast<Eigen::Index>(k)] = group[prefix + coordinate_names[k]].number();
  return pose;
}

void
refuseWhatIsMissing(const JsonNode& document)
{
  const std::string name = document["method"].text();
  if (keys_of_groups.count(name) == 0 || name == "prior" || name == "icp")
    throw io::UsageError("unknown method " + io::inQuotes(name));
  if (name != "preconditioned_sgld")
    throw io::UsageError("the method '" + name +
                         "' is not available in this version; preconditioned_sgld is");
}

void
takeSampler(const JsonNode& document, Options& options)
{
  const JsonNode method = document["preconditioned_sgld"];
  SgldOptions& sgld = options.paper.sgld;
  sgld.step_size = method["step-size"].number();
  sgld.decay_rate = method["decay-rate"].number();
  sgld.noise_factor = method["adjust_noise"].number();
  sgld.block_decay_factor = 1.0;
  options.paper.batch_size = countOf(document["icp"]["batch-size"]);
  options.paper.sampling = MiniBatchSampling::ShuffledEpochs;
  options.chains.num_chains = 1;
  options.chains.num_draws = countOf(document["icp"]["max-iterations"]);
}

std::string
noteAbout(const JsonNode& document)
{
  std::string ignored;
  for (const char* key :
       {"convergence-steps", "translational-convergence", "rotational-convergence"})
    if (document["icp"].has(key))
      ignored += std::string(ignored.empty() ? "" : ", ") + "icp." + key;
  return ignored.empty() ? "" : ignored + ": no effect on sampling";
}

/** Whether a JSON object is of that layout. */
bool
isAuthorsConfig(const json& document)
{
  for (const char* key : {"method", "icp", "initial-guess", "preconditioned_sgld"})
    if (document.contains(key))
      return true;
  return false;
}

/** Settings that do what the authors' program does.
 *
 * What that program does with method "preconditioned_sgld", and what becomes of it
 * here: one chain of icp.max-iterations draws without burn-in and block decay; alpha =
 * step-size over the number of source points; N the number of source points; noise
 * variance adjust_noise alpha A; beta = decay-rate; one prior variance for all
 * coordinates; mini-batches from a shuffled source; icp.max-matching-distance as the
 * gate; normalize-cloud scales both clouds, and all lengths of the file are then in
 * scaled units; icp.filter rejects repeated matches of one target point. Its
 * convergence limits concern its optimisers only. */
Settings
settingsOfAuthorsConfig(const json& file)
{
  const JsonNode document(file);
  checkKeys(document);
  refuseWhatIsMissing(document);
  Settings settings;
  settings.options.preset = Preset::Paper;
  settings.guess = matrixOf(poseOf(document["initial-guess"], ""));
  settings.options.prior.mean = poseOf(document["prior"], "mean-");
  settings.options.prior.variance.setConstant(document["prior"]["variance"].number());
  settings.max_distance = document["icp"]["max-matching-distance"].number();
  settings.is_one_to_one = flagOf(document["icp"]["filter"]);
  settings.is_normalized = settings.are_lengths_scaled =
      document.has("normalize-cloud") && flagOf(document["normalize-cloud"]);
  settings.is_step_size_times_points = true;
  settings.is_effective_points_source_size = true;
  takeSampler(document, settings.options);
  settings.note = noteAbout(document);
  return settings;
}

} // namespace

Settings
readConfigFile(const std::string& file, const std::optional<Preset>& preset)
{
  const json document = io::readJson(file, max_config_size);
  try {
    if (!document.is_object())
      throw io::UsageError("is not a JSON object");
    if (document.contains("schema"))
      return settingsOfPosterior(preset, document);
    if (!isAuthorsConfig(document))
      return settingsWith(preset, document);
    if (preset.value_or(Preset::Paper) != Preset::Paper)
      throw io::UsageError(std::string("is for preset paper, and the preset is ") +
                           toString(*preset));
    return settingsOfAuthorsConfig(document);
  }
  catch (const io::UsageError& error) {
    throw io::UsageError(file + ": " + error.what());
  }
}

} // namespace bayesian_icp::app
