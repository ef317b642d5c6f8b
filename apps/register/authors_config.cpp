#include "register/authors_config.h"

#include "io/coordinates.h"
#include "io/errors.h"
#include "register/json_values.h"

#include <bayesian_icp/pose.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace bayesian_icp::app {

namespace {

using nlohmann::json;

/** The keys of the layout; an empty set is a value of its own. */
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
flagOf(const std::string& path, const json& value)
{
  if (value.is_boolean())
    return value.get<bool>();
  if (value != 0 && value != 1)
    refuse(path, value, "true or false");
  return value == 1;
}

void
checkGroup(const std::string& name,
           const std::set<std::string>& keys,
           const json& group)
{
  if (!group.is_object())
    refuse(name, group, "an object");
  for (const auto& [key, value] : group.items()) {
    const std::string path = keyPath(name, key);
    if (keys.count(key) == 0)
      throw io::UsageError("unknown key " + io::inQuotes(path));
    if (path != "icp.filter" && !value.is_number())
      refuse(path, value, "a number");
  }
}

void
checkKeys(const json& document)
{
  for (const auto& [name, value] : document.items()) {
    const auto found = keys_of_groups.find(name);
    if (found == keys_of_groups.end())
      throw io::UsageError("unknown key " + io::inQuotes(name));
    if (!found->second.empty())
      checkGroup(name, found->second, value);
  }
}

const json&
at(const json& document, const std::string& group, const std::string& key)
{
  if (!document.contains(group) || !document[group].contains(key))
    throw io::UsageError("the key '" + group + '.' + key + "' is missing");
  return document[group][key];
}

double
numberAt(const json& document, const std::string& group, const std::string& key)
{
  return at(document, group, key).get<double>();
}

int
countAt(const json& document, const std::string& group, const std::string& key)
{
  const double number = numberAt(document, group, key);
  if (number != std::floor(number) || number < 1 ||
      number > std::numeric_limits<int>::max())
    refuse(group + '.' + key, at(document, group, key), "a positive whole number");
  return static_cast<int>(number);
}

Vector6d
poseAt(const json& document, const std::string& group, const std::string& prefix)
{
  Vector6d pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[static_cast<Eigen::Index>(k)] =
        numberAt(document, group, prefix + coordinate_names[k]);
  return pose;
}

void
refuseWhatIsMissing(const json& document)
{
  const json method = document.value("method", json());
  if (!method.is_string())
    refuse("method", method, "the name of a method");
  const std::string name = method.get<std::string>();
  if (keys_of_groups.count(name) == 0 || name == "prior" || name == "icp")
    throw io::UsageError("unknown method " + io::inQuotes(name));
  if (name != "preconditioned_sgld")
    throw io::UsageError("the method '" + name +
                         "' is not available in this version; preconditioned_sgld is");
}

void
takeSampler(const json& document, Options& options)
{
  const std::string method = "preconditioned_sgld";
  SgldOptions& sgld = options.paper.sgld;
  sgld.step_size = numberAt(document, method, "step-size");
  sgld.decay_rate = numberAt(document, method, "decay-rate");
  sgld.noise_factor = numberAt(document, method, "adjust_noise");
  sgld.block_decay_factor = 1.0;
  options.paper.batch_size = countAt(document, "icp", "batch-size");
  options.paper.sampling = MiniBatchSampling::ShuffledEpochs;
  options.chains.num_chains = 1;
  options.chains.num_draws = countAt(document, "icp", "max-iterations");
}

std::string
noteAbout(const json& document)
{
  std::string ignored;
  for (const char* key :
       {"convergence-steps", "translational-convergence", "rotational-convergence"})
    if (document["icp"].contains(key))
      ignored += std::string(ignored.empty() ? "" : ", ") + "icp." + key;
  return ignored.empty() ? "" : ignored + ": no effect on sampling";
}

} // namespace

bool
isAuthorsConfig(const json& document)
{
  for (const char* key : {"method", "icp", "initial-guess", "preconditioned_sgld"})
    if (document.contains(key))
      return true;
  return false;
}

Settings
settingsOfAuthorsConfig(const json& document, std::string& note)
{
  checkKeys(document);
  refuseWhatIsMissing(document);
  Settings settings;
  settings.options.preset = Preset::Paper;
  settings.guess = matrixOf(poseAt(document, "initial-guess", ""));
  settings.options.prior.mean = poseAt(document, "prior", "mean-");
  settings.options.prior.variance.setConstant(numberAt(document, "prior", "variance"));
  settings.max_distance = numberAt(document, "icp", "max-matching-distance");
  settings.is_one_to_one = flagOf("icp.filter", at(document, "icp", "filter"));
  settings.is_normalized = settings.are_lengths_scaled =
      flagOf("normalize-cloud", document.value("normalize-cloud", json(false)));
  settings.is_step_size_times_points = true;
  settings.is_effective_points_source_size = true;
  takeSampler(document, settings.options);
  note = noteAbout(document);
  return settings;
}

} // namespace bayesian_icp::app
