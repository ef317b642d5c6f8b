#include "batch/batch_file.h"

#include "io/errors.h"
#include "io/folders.h"
#include "io/numbers.h"
#include "register/json_values.h"
#include "register/posterior_files.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace bayesian_icp::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr const char* rank_suffix = ".rank";

/** The rank files beside \p name. */
std::vector<std::string>
rankFilesOf(const std::string& name)
{
  const std::string start = fs::path(name).filename().string() + rank_suffix;
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(io::folderOf(name))) {
    const std::string candidate = entry.path().filename().string();
    int rank = 0;
    if (candidate.rfind(start, 0) == 0 &&
        io::readNumber(std::string_view(candidate).substr(start.size()), rank))
      found.push_back(entry.path().string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

void
addPosterior(const Run& run, ordered_json& line)
{
  const RegistrationResult& result = run.result;
  line["mean"] = meanJson(result.summary.mean);
  for (const auto convention :
       {CovarianceConvention::Parameters, CovarianceConvention::RightSE3})
    line["covariances"].push_back(
        covarianceJson(convention, result.summary.covariance(convention)));
  line["final_transformation"] = finalTransformationJson(run);
  line["icp"] = icpJson(result);
  line["draws"] = result.summary.num_draws;
  line["source"] = cloudJson(run.source);
  line["target"] = cloudJson(run.target);
  line["time"] = timeJson(run);
}

void
addNothing(const BatchPair& pair, ordered_json& line)
{
  for (const char* const key : {"mean", "covariances", "final_transformation", "icp"})
    line[key] = nullptr;
  line["draws"] = 0;
  line["source"] = {{"file", pair.source_file}};
  line["target"] = {{"file", pair.target_file}};
  line["time"] = ordered_json::object();
}

} // namespace

std::string
batchLine(const BatchResult& result)
{
  std::string message = result.message;
  std::replace(message.begin(), message.end(), '\n', ' ');
  ordered_json line = {
      {"name", result.pair.name}, {"status", result.status}, {"message", message}};
  if (result.run != nullptr)
    addPosterior(*result.run, line);
  else
    addNothing(result.pair, line);
  line["time"]["total_s"] = result.seconds;
  line["seed"] = result.pair.settings.options.chains.seed;
  line["settings_id"] = result.pair.settings_id;
  line["files_state"] = result.files_state;
  return jsonText(line);
}

std::string
rankFileName(const std::string& name, int rank)
{
  return name + rank_suffix + io::textOf(rank);
}

BatchFile::BatchFile(const std::string& name, const std::vector<BatchPair>& pairs)
: name_(name)
, pairs_(pairs)
{
  for (const BatchPair& pair : pairs)
    pairs_by_name_[pair.name] = &pair;
  file_ = std::make_unique<io::LineFile>(
      name, [this](const std::string& line) { return note(line); });
  takeRankFiles();
}

bool
BatchFile::note(const std::string& line)
{
  std::string pair, settings_id, files_state, status;
  try {
    const auto document = nlohmann::json::parse(line);
    document.at("name").get_to(pair);
    document.at("settings_id").get_to(settings_id);
    document.at("files_state").get_to(files_state);
    document.at("status").get_to(status);
  }
  catch (const nlohmann::json::exception&) {
    throw io::FileError(name_,
                        "has a line that is not a result: " + io::inQuotes(line));
  }
  const auto found = pairs_by_name_.find(pair);
  if (found != pairs_by_name_.end() && found->second->settings_id != settings_id)
    throw io::FileError(name_,
                        "has a result of pair " + io::inQuotes(pair) +
                            " with other settings, files or program version; use "
                            "another file, or remove its line");
  const std::string state =
      found != pairs_by_name_.end() ? found->second->filesState() : "";
  if (!state.empty() && state != files_state) {
    ++num_changed_;
    return false;
  }
  return statuses_.emplace(pair, status).second;
}

void
BatchFile::takeRankFiles()
{
  for (const std::string& name : rankFilesOf(name_)) {
    const io::LineFile part(name, [this](const std::string& line) {
      if (note(line))
        file_->add(line);
      return true;
    });
    std::error_code error;
    if (!fs::remove(name, error))
      throw io::FileError(name, "cannot be removed: " + error.message());
  }
}

void
BatchFile::add(const std::string& line)
{
  file_->add(line);
  note(line);
}

std::vector<std::size_t>
BatchFile::remaining() const
{
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    if (statuses_.count(pairs_[i].name) == 0)
      positions.push_back(i);
  return positions;
}

std::vector<std::size_t>
BatchFile::registered() const
{
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto found = statuses_.find(pairs_[i].name);
    if (found != statuses_.end() && found->second != error_status)
      positions.push_back(i);
  }
  return positions;
}

bool
BatchFile::areAllOk() const
{
  const std::string ok = toString(Status::Ok);
  return std::all_of(pairs_.begin(), pairs_.end(), [&](const BatchPair& pair) {
    const auto found = statuses_.find(pair.name);
    return found != statuses_.end() && found->second == ok;
  });
}

} // namespace bayesian_icp::app
