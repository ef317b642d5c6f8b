#include "batch/manifest.h"

#include "io/input_file.h"
#include "io/json_file.h"
#include "io/motion.h"
#include "io/text_hash.h"
#include "register/settings_json.h"

#include <bayesian_icp/pose.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace bayesian_icp::app {

namespace {

using io::JsonNode;
using nlohmann::json;

constexpr std::uint64_t max_manifest_size = 256 << 20;
constexpr std::size_t max_name_size = 200;

/** A text that is not empty. */
std::string
textOf(const JsonNode& value)
{
  if (!value.json().is_string() || value.text().empty())
    value.refuse("a string that is not empty");
  return value.text();
}

/** Names are those of folders, too. */
std::string
nameOf(const JsonNode& value)
{
  std::string name = textOf(value);
  bool is_good = name.size() <= max_name_size && name.front() != '.';
  for (const char character : name)
    is_good &= character != '/' && static_cast<unsigned char>(character) >= 0x20;
  if (!is_good)
    value.refuse("usable as the name of a folder: no '/', no leading '.'");
  return name;
}

double
positiveOf(const JsonNode& value)
{
  const double number = value.number();
  if (!(number > 0.0))
    value.refuse("a positive number");
  return number;
}

/** Standard deviations about the guess and the source's centroid. */
PriorOptions
suggestedPrior(const JsonNode& sigma)
{
  const double translation = positiveOf(sigma["translation_m"]);
  const double rotation = positiveOf(sigma["rotation_rad"]);
  PriorOptions prior;
  prior.frame = PriorFrame::SourceCentroid;
  prior.variance << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return prior;
}

void
takeGuess(const JsonNode& guess, BatchPair& pair)
{
  const json& numbers = guess.json();
  const auto isNumber = [](const json& item) { return item.is_number(); };
  if (numbers.is_string() && !guess.text().empty())
    pair.guess_file = guess.text();
  else if (numbers.is_array() && numbers.size() == 6 &&
           std::all_of(numbers.begin(), numbers.end(), isNumber) &&
           io::areAnglesWithinATurn(guess.matrix<Vector6d>()))
    pair.settings.guess = matrixOf(guess.matrix<Vector6d>());
  else
    guess.refuse(
        "the six numbers [x, y, z, roll, pitch, yaw] [m, rad], angles within a turn, "
        "or the name of a file with a 4x4 matrix");
}

void
takeSettings(const json& settings, BatchPair& pair)
{
  pair.settings = settingsOf(settings, pair.settings);
  const std::string complaint = pair.settings.validate();
  if (!complaint.empty())
    throw io::UsageError(complaint);
}

/** A pair of the layout of docs/batch.md. */
void
takePlainEntry(const JsonNode& entry, BatchPair& pair)
{
  entry.requireKeysAmong(
      {"name", "source", "target", "guess", "settings", "suggested_prior_sigma"});
  pair.source_file = textOf(entry["source"]);
  pair.target_file = textOf(entry["target"]);
  if (entry.has("settings"))
    takeSettings(entry["settings"].json(), pair);
  if (entry.has("guess"))
    takeGuess(entry["guess"], pair);
}

/** A pair of a data set, whose entries describe it in further keys. */
void
takeDataSetEntry(const JsonNode& files, BatchPair& pair)
{
  pair.source_file = textOf(files["source"]);
  pair.target_file = textOf(files["target"]);
  if (files.has("initial_guess"))
    pair.guess_file = textOf(files["initial_guess"]);
}

void
identify(BatchPair& pair)
{
  Settings& settings = pair.settings;
  settings.options.chains.num_threads = 0;
  std::string all = jsonOf(settings).dump() + '\n' + pair.source_file + '\n' +
                    pair.target_file + '\n' + pair.guess_file + '\n' +
                    BAYESIAN_ICP_VERSION;
  for (const bool is_in_units_of_cloud : {settings.are_lengths_scaled,
                                          settings.is_step_size_times_points,
                                          settings.is_effective_points_source_size})
    all += is_in_units_of_cloud ? '1' : '0';
  pair.settings_id = io::textOfHash(io::hashOf(all));
}

/** Whether an entry states a pose or a distance of its own. */
bool
hasLengths(const JsonNode& entry)
{
  if (entry.has("guess") || (entry.has("files") && entry["files"].has("initial_guess")))
    return true;
  const auto isStated = [&entry](const char* group) {
    return entry["settings"].has(group);
  };
  return entry.has("settings") &&
         (isStated("prior") || isStated("registration") || isStated("paper"));
}

BatchPair
pairOf(const JsonNode& entry, const Settings& settings, bool use_suggested_prior)
{
  BatchPair pair;
  pair.settings = settings;
  pair.name = nameOf(entry["name"]);
  if (settings.are_lengths_scaled && (use_suggested_prior || hasLengths(entry)))
    throw io::UsageError("lengths of a pair are in metres, but with normalize-cloud "
                         "those of --config are in units of the clouds");
  if (use_suggested_prior)
    pair.settings.options.prior = suggestedPrior(entry["suggested_prior_sigma"]);
  if (entry.has("files"))
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

std::string
BatchPair::filesState() const
{
  std::vector<std::string> files = {source_file, target_file};
  if (!guess_file.empty())
    files.push_back(guess_file);
  return io::stateOf(files);
}

std::vector<BatchPair>
readManifest(const std::string& file,
             const Settings& settings,
             bool use_suggested_prior)
{
  const json manifest = io::readJson(file, max_manifest_size);
  if (!manifest.is_array())
    throw io::FileError(file, "is not a JSON list of pairs");
  if (manifest.empty())
    throw io::FileError(file, "has no pairs");
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  std::vector<BatchPair> pairs;
  std::set<std::string> names;
  for (const json& entry : manifest) {
    std::string what = "pair " + std::to_string(pairs.size() + 1);
    try {
      const io::JsonNode value(entry);
      if (value.has("name"))
        what += " (" + io::inQuotes(entry["name"].dump()) + ")";
      BatchPair pair = pairOf(value, settings, use_suggested_prior);
      if (!names.insert(pair.name).second)
        throw io::UsageError("another pair has this name, too");
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
