#include "batch/batch_file.h"

#include "batch/batch_line.h"
#include "io/errors.h"
#include "io/folders.h"
#include "io/numbers.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace bayesian_icp::app {

namespace fs = std::filesystem;

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

} // namespace

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
    settings_ids_[pair.name] = pair.settings_id;
  file_ = std::make_unique<io::LineFile>(
      name, [this](const std::string& line) { note(line); });
  takeRankFiles();
}

bool
BatchFile::note(const std::string& line)
{
  FinishedPair finished;
  try {
    finished = readBatchLine(line);
  }
  catch (const std::exception&) {
    throw io::FileError(name_, "has a line that is no result: " + io::inQuotes(line));
  }
  const auto found = settings_ids_.find(finished.name);
  if (found != settings_ids_.end() && found->second != finished.settings_id)
    throw io::FileError(name_,
                        "has a result of pair " + io::inQuotes(finished.name) +
                            " with other settings, files or program version; take "
                            "another file, or remove its line");
  return statuses_.emplace(finished.name, finished.status).second;
}

void
BatchFile::takeRankFiles()
{
  for (const std::string& name : rankFilesOf(name_)) {
    const io::LineFile part(name, [this](const std::string& line) {
      if (note(line))
        file_->add(line);
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

std::size_t
BatchFile::numFinished() const
{
  return pairs_.size() - remaining().size();
}

std::size_t
BatchFile::numNotOk() const
{
  const std::string ok = toString(Status::Ok);
  return static_cast<std::size_t>(
      std::count_if(pairs_.begin(), pairs_.end(), [&](const BatchPair& pair) {
        const auto found = statuses_.find(pair.name);
        return found != statuses_.end() && found->second != ok;
      }));
}

} // namespace bayesian_icp::app
