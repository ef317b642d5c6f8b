#include "coverage/coverage_real.h"

#include "coverage/coverage_cases.h"
#include "io/numbers.h"
#include "io/text_hash.h"
#include "methods/baseline_problem.h"
#include "study/named.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/random.h>

#include <cmath>

namespace bayesian_icp::evaluate {

using Eigen::Isometry3d;

namespace {

/** Of the motion by which a source is turned [rad, m]. */
constexpr double turn_angle = 0.5;
constexpr double turn_shift = 0.5;

/** At most \p size of the items, evenly spread with the first and the last; all for 0.
 */
std::vector<std::uint64_t>
spread(const std::vector<std::uint64_t>& items, std::size_t size)
{
  if (size == 0 || items.size() <= size)
    return items;
  const double distance = static_cast<double>(items.size() - 1) /
                          static_cast<double>(std::max<std::size_t>(size - 1, 1));
  std::vector<std::uint64_t> chosen;
  for (std::size_t k = 0; k < size; ++k)
    chosen.push_back(
        items[static_cast<std::size_t>(std::lrint(static_cast<double>(k) * distance))]);
  return chosen;
}

PairPoses
randomPoses(const Isometry3d& T_target_sensor,
            const AxisDeviation& guess_sd,
            Random& random)
{
  const Vector6d direction = random.normal6();
  Isometry3d T_turned_sensor = Isometry3d::Identity();
  T_turned_sensor.linear() = expSO3(turn_angle * direction.tail<3>().normalized());
  T_turned_sensor.translation() = turn_shift * direction.head<3>().normalized();
  return {perturbed(T_target_sensor, guess_sd, random) * T_turned_sensor.inverse(),
          T_target_sensor * T_turned_sensor.inverse()};
}

} // namespace

CoverageCase
makeRealCase(const std::string& folder, const ManifestEntry& entry, std::uint64_t seed)
{
  const ScanPair pair = readScanPair(folder, entry);
  // Cases of one seed share no random numbers.
  Random random(seed, io::hashOf(entry.name));
  CoverageCase made;
  made.scene = entry.name;
  made.condition = real_pair;
  made.seed = seed;
  made.target = pair.target;
  made.prior_sd = entry.prior_sd->vector();
  made.truth_sd = entry.truth_sd;
  const auto part = randomChoice(pair.source.cols(), max_source_points, random);
  made.source = pair.truth * pair.source(Eigen::all, part);
  displaceSource(random, made);
  return made;
}

SequencePairs::SequencePairs(const std::string& folder, const SequenceOptions& options)
: options_(options)
, recordings_(readRecordings(folder))
{
  guesses_ = " step " + io::textOf(options.step);
  if (!options.rows_file.empty()) {
    readRows();
    return;
  }
  guesses_ += " guess-sd " + io::textOf(options.guess_sd.translation) + ' ' +
              io::textOf(options.guess_sd.rotation) + " seed " +
              io::textOf(options.seed);
}

void
SequencePairs::readRows()
{
  std::uint64_t hash = io::hash_of_nothing;
  readPairPoses(
      options_.rows_file,
      [&](const std::string& set, std::uint64_t pair, const PairPoses& poses) {
        const Recording& recording = recordingOf(set);
        const std::string name = "pair " + std::to_string(pair) + " of " + set;
        if (pair >= numPairs(recording))
          throw std::runtime_error("there is no " + name);
        if (!rows_[set].emplace(pair, poses).second)
          throw std::runtime_error(name + " is there twice");
        for (const Isometry3d* pose : {&poses.guess, &poses.truth})
          for (const double number : pose->matrix().reshaped())
            hash = io::hashOf(name + ' ' + io::textOf(number), hash);
      });
  guesses_ += " rows " + io::textOfHash(hash);
}

std::vector<std::string>
SequencePairs::names() const
{
  return namesOf(recordings_);
}

const Recording&
SequencePairs::recordingOf(const std::string& name) const
{
  const Recording* const recording = findNamed(recordings_, name);
  if (recording == nullptr)
    throw std::runtime_error("there is no set " + io::inQuotes(name));
  return *recording;
}

std::size_t
SequencePairs::numPairs(const Recording& recording) const
{
  const std::size_t num_scans = recording.poses.size();
  return num_scans > options_.step ? num_scans - options_.step : 0;
}

std::string
SequencePairs::condition(const std::string& name) const
{
  return recordingOf(name).quality + guesses_;
}

std::vector<std::uint64_t>
SequencePairs::pairs(const std::string& name) const
{
  std::vector<std::uint64_t> all;
  const auto rows = rows_.find(name);
  for (std::uint64_t pair = 0; pair < numPairs(recordingOf(name)); ++pair)
    if (options_.rows_file.empty() ||
        (rows != rows_.end() && rows->second.count(pair) > 0))
      all.push_back(pair);
  return spread(all, options_.max_pairs);
}

PairPoses
SequencePairs::posesOf(const Recording& recording, std::uint64_t pair) const
{
  if (!options_.rows_file.empty())
    return rows_.at(recording.name).at(pair);
  Random random(options_.seed, io::hashOf(recording.name + ' ' + io::textOf(pair)));
  return randomPoses(
      recording.relativePose(pair, pair + options_.step), options_.guess_sd, random);
}

CoverageCase
SequencePairs::makeCase(const std::string& name, std::uint64_t pair) const
{
  const Recording& recording = recordingOf(name);
  const std::size_t source = pair + options_.step;
  const PairPoses poses = posesOf(recording, pair);
  const Isometry3d T_turned_sensor =
      poses.truth.inverse() * recording.relativePose(pair, source);
  CoverageCase made;
  made.scene = name;
  made.condition = condition(name);
  made.seed = ChainOptions().seed;
  made.source = T_turned_sensor * recording.read(source);
  made.target = recording.read(pair);
  made.truth = poses.truth;
  made.prior_mean = poseOf(poses.guess.matrix());
  made.prior_sd = PriorOptions().variance.cwiseSqrt();
  made.truth_sd = recording.truth_sd;
  made.sensor = T_turned_sensor.translation();
  made.lost_displacement = recording.lost_displacement;
  return made;
}

} // namespace bayesian_icp::evaluate
