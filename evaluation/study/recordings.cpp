#include "study/recordings.h"

#include "io/cloud_file.h"
#include "io/errors.h"
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/motion.h"
#include "io/numbers.h"
#include "study/scan_pairs.h"
#include "study/text_table.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace fs = std::filesystem;

using Eigen::Isometry3d;
using io::JsonNode;
using nlohmann::json;

namespace {

constexpr char set_name[] = "set.json";
constexpr std::uint64_t max_set_size = 1 << 20;

/** Hand the lines of a file to \p read; what it throws is told with the line's number.
 * \throws io::FileError */
void
forEachLine(const std::string& file,
            const std::function<void(const std::string& line)>& read)
{
  io::InputFile input = io::openInput(file);
  std::string line;
  int number = 1;
  const auto refuse = [&](const std::string& reason) {
    throw io::FileError(file, "line " + std::to_string(number) + ": " + reason);
  };
  for (; input.readLine(line); ++number)
    try {
      read(line);
    }
    catch (const std::exception& error) {
      refuse(error.what());
    }
  if (input.numBytesLeft() > 0)
    refuse("is too long");
}

/** The motion of the 12 numbers of a 3 x 4 matrix.
 * \throws std::runtime_error if they are not those of one */
Isometry3d
motionOf(const std::vector<double>& numbers)
{
  if (numbers.size() != 12)
    throw std::runtime_error("has " + std::to_string(numbers.size()) +
                             " numbers in place of the 12 of a 3x4 matrix");
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRows<3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  const std::string complaint = io::complaintAboutMotion(matrix);
  if (!complaint.empty())
    throw std::runtime_error(complaint);
  return Isometry3d(matrix);
}

Isometry3d
motionOf(const std::string& line)
{
  std::vector<double> numbers;
  for (const std::string_view word : io::words(line))
    if (!io::readNumber(word, numbers.emplace_back()))
      throw std::runtime_error(io::inQuotes(word) + " is not a number");
  return motionOf(numbers);
}

/** \throws io::UsageError, std::runtime_error */
Isometry3d
motionAt(const JsonNode& object, const char* key)
{
  std::vector<double> numbers;
  for (const json& row : object[key].json())
    for (const json& number : row)
      numbers.push_back(JsonNode(number, key).number());
  try {
    return motionOf(numbers);
  }
  catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(key) + ": " + error.what());
  }
}

/** \throws io::UsageError, std::runtime_error if it is not at least 0 */
double
lengthAt(const JsonNode& object, const char* key)
{
  const double length = object[key].number();
  if (!(length >= 0.0) || std::isinf(length))
    throw std::runtime_error(std::string(key) + " must be finite and not negative");
  return length;
}

std::string
scanFile(const fs::path& folder, std::size_t scan)
{
  return (folder / format("scan_%04zu.pcd", scan)).string();
}

Recording
readRecording(const fs::path& folder)
{
  Recording recording;
  recording.name = folder.filename().string();
  recording.read = [folder](std::size_t scan) -> Eigen::Matrix3Xd {
    return io::readFinitePoints(scanFile(folder, scan)).cast<double>();
  };
  const std::string set_file = (folder / set_name).string();
  const json document = io::readJson(set_file, max_set_size);
  try {
    const JsonNode set(document);
    recording.quality = set["quality"].text();
    if (recording.quality != "A" && recording.quality != "B" &&
        recording.quality != "C")
      throw std::runtime_error("quality is " + io::inQuotes(recording.quality) +
                               ", but must be A, B or C");
    recording.truth_sd = {lengthAt(set, "accuracy_translation_m"),
                          lengthAt(set, "accuracy_rotation_rad")};
    recording.lost_displacement = lengthAt(set, "lost_displacement_m");
  }
  catch (const std::exception& error) {
    throw io::FileError(set_file, error.what());
  }
  const std::string poses_file = (folder / "poses.txt").string();
  forEachLine(poses_file, [&recording](const std::string& line) {
    recording.poses.push_back(motionOf(line));
  });
  std::size_t num_scans = 0;
  while (fs::exists(scanFile(folder, num_scans)))
    ++num_scans;
  if (num_scans != recording.poses.size())
    throw io::FileError(poses_file,
                        "there are " + io::textOf(num_scans) + " scans, but " +
                            io::textOf(recording.poses.size()) + " lines");
  return recording;
}

} // namespace

std::vector<Recording>
readRecordings(const std::string& folder)
{
  std::vector<fs::path> folders;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (fs::exists(entry.path() / set_name))
      folders.push_back(entry.path());
    else if (fs::exists(scanFile(entry.path(), 0)))
      std::cerr << entry.path().string() + ": note: has no " + set_name +
                       ", so its scans are left out\n";
  if (error)
    throw io::FileError(folder, error.message());
  if (folders.empty())
    throw io::FileError(folder,
                        std::string("has neither a ") + manifest_name +
                            " nor a folder with a " + set_name);
  std::sort(folders.begin(), folders.end());
  std::vector<Recording> recordings;
  for (const fs::path& path : folders)
    recordings.push_back(readRecording(path));
  return recordings;
}

void
readPairPoses(
    const std::string& file,
    const std::function<
        void(const std::string& set, std::uint64_t pair, const PairPoses& poses)>& take)
{
  forEachLine(file, [&take](const std::string& line) {
    const json object = json::parse(line, nullptr, false);
    if (object.is_discarded())
      throw std::runtime_error("broken JSON");
    const JsonNode row(object), pair = row["pair"];
    if (!pair.json().is_number_unsigned())
      pair.refuse("the number of a scan");
    take(row["set"].text(),
         pair.json().get<std::uint64_t>(),
         {motionAt(row, "guess"), motionAt(row, "truth")});
  });
}

} // namespace bayesian_icp::evaluate
