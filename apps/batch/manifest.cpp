#include "batch/manifest.h"

#include "io/errors.h"
#include "io/json_file.h"
#include "io/text_hash.h"
#include "register/settings_json.h"

#include <bayesian_icp/pose.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <set>

namespace bayesian_icp::app {

namespace {

using nlohmann::json;

constexpr std::uint64_t max_manifest_size = 256 << 20;
constexpr std::size_t max_name_size = 200;

/** What is wrong with a pair; readManifest() puts file and name before it. */
[[noreturn]] void
refuse(const std::string& complaint)
{
  throw io::UsageError(complaint);
}

std::string
textAt(const json& object, const char* key)
{
  if (!object.contains(key))
    refuse(std::string("the key '") + key + "' is missing");
  const json& value = object[key];
  if (!value.is_string() || value.get_ref<const std::string&>().empty())
    refuse(std::string(key) + " is " + io::inQuotes(value.dump()) +
           ", but must be a text");
  return value;
}

/** Names are those of folders, too. */
std::string
nameOf(const json& entry)
{
  std::string name = textAt(entry, "name");
  bool is_good = name.size() <= max_name_size && name.front() != '.';
  for (const char character : name)
    is_good &= character != '/' && static_cast<unsigned char>(character) >= 0x20;
  if (!is_good)
    refuse("name is " + io::inQuotes(name) +
           ", but must be usable as the name of a folder: no '/', no leading '.'");
  return name;
}

double
positiveAt(const json& object, const char* key)
{
  if (!object.is_object() || !object.contains(key) || !object[key].is_number() ||
      !(object[key].get<double>() > 0.0))
    refuse(std::string("suggested_prior_sigma.") + key +
           " is missing or not a positive number");
  return object[key];
}

/** Standard deviations about the guess and the source's centroid. */
PriorOptions
suggestedPrior(const json& entry)
{
  const json sigma = entry.value("suggested_prior_sigma", json());
  const double translation = positiveAt(sigma, "translation_m");
  const double rotation = positiveAt(sigma, "rotation_rad");
  PriorOptions prior;
  prior.frame = PriorFrame::SourceCentroid;
  prior.variance << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return prior;
}

void
takeGuess(const json& guess, BatchPair& pair)
{
  if (guess.is_string() && !guess.get_ref<const std::string&>().empty()) {
    pair.guess_file = guess;
    return;
  }
  bool is_good = guess.is_array() && guess.size() == 6;
  Vector6d pose = Vector6d::Zero();
  for (std::size_t k = 0; is_good && k < 6; ++k) {
    is_good = guess[k].is_number();
    if (is_good)
      pose[static_cast<Eigen::Index>(k)] = guess[k].get<double>();
  }
  if (!is_good)
    refuse("guess is " + io::inQuotes(guess.dump()) +
           ", but must be the six numbers [x, y, z, roll, pitch, yaw] [m, rad] or the "
           "name of a file with a 4x4 matrix");
  pair.settings.guess = matrixOf(pose);
}

void
takeSettings(const json& settings, BatchPair& pair)
{
  pair.settings = settingsOf(settings, pair.settings);
  const std::string complaint = pair.settings.validate();
  if (!complaint.empty())
    refuse(complaint);
}

/** A pair of the layout of docs/batch.md. */
void
takePlainEntry(const json& entry, BatchPair& pair)
{
  static const std::set<std::string> known = {
      "name", "source", "target", "guess", "settings", "suggested_prior_sigma"};
  for (const auto& [key, value] : entry.items())
    if (known.count(key) == 0)
      refuse("unknown key " + io::inQuotes(key));
  pair.source_file = textAt(entry, "source");
  pair.target_file = textAt(entry, "target");
  if (entry.contains("settings"))
    takeSettings(entry["settings"], pair);
  if (entry.contains("guess"))
    takeGuess(entry["guess"], pair);
}

/** A pair of a data set, whose entries describe it in further keys. */
void
takeDataSetEntry(const json& files, BatchPair& pair)
{
  if (!files.is_object())
    refuse("files is not an object");
  pair.source_file = textAt(files, "source");
  pair.target_file = textAt(files, "target");
  if (files.contains("initial_guess"))
    pair.guess_file = textAt(files, "initial_guess");
}

void
identify(BatchPair& pair)
{
  pair.settings.options.chains.num_threads = 0;
  const std::string all = jsonOf(pair.settings).dump() + '\n' + pair.source_file +
                          '\n' + pair.target_file + '\n' + pair.guess_file + '\n' +
                          BAYESIAN_ICP_VERSION;
  pair.settings_id = io::textOfHash(io::hashOf(all));
}

BatchPair
pairOf(const json& entry, const Settings& settings, bool use_suggested_prior)
{
  BatchPair pair;
  pair.settings = settings;
  pair.name = nameOf(entry);
  if (use_suggested_prior)
    pair.settings.options.prior = suggestedPrior(entry);
  if (entry.contains("files"))
    takeDataSetEntry(entry["files"], pair);
  else
    takePlainEntry(entry, pair);
  identify(pair);
  return pair;
}

/** The manifest's folder before \p name, if that is relative. */
void
placeIn(const std::filesystem::path& folder, std::string& name)
{
  if (!name.empty())
    name = (folder / name).string();
}

} // namespace

std::vector<BatchPair>
readManifest(const std::string& file,
             const Settings& settings,
             bool use_suggested_prior)
{
  const json manifest = io::readJson(file, max_manifest_size);
  if (!manifest.is_array())
    throw io::FileError(file, "is not a JSON list of pairs");
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  std::vector<BatchPair> pairs;
  std::set<std::string> names;
  for (const json& entry : manifest) {
    std::string what = "pair " + std::to_string(pairs.size() + 1);
    try {
      if (!entry.is_object())
        refuse("is not a JSON object");
      if (entry.contains("name"))
        what += " (" + io::inQuotes(entry["name"].dump()) + ")";
      BatchPair pair = pairOf(entry, settings, use_suggested_prior);
      if (!names.insert(pair.name).second)
        refuse("another pair has this name, too");
      for (std::string* name : {&pair.source_file, &pair.target_file, &pair.guess_file})
        placeIn(folder, *name);
      pairs.push_back(std::move(pair));
    }
    catch (const io::UsageError& error) {
      throw io::FileError(file, what + ": " + error.what());
    }
  }
  return pairs;
}

} // namespace bayesian_icp::app
