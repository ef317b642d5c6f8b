#include "commands.h"
#include "io/coordinates.h"
#include "io/errors.h"
#include "io/folders.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "io/text_hash.h"
#include "register/choices.h"
#include "study/input_hash.h"
#include "study/named.h"
#include "study/option_values.h"
#include "study/parallel_tasks.h"
#include "study/text_table.h"
#include "threads/for_each_piece.h"
#include "trajectories/drives.h"
#include "trajectories/trajectory_run.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

constexpr double milli = 1e3;

struct TrajectoriesOptions {
  std::vector<std::string> names;
  int num_seeds = 1;
  int first_seed = 1;
  int num_scans = 100;
  int span = 3;
  double closure_distance = 1.0;
  int num_threads = 0;
  ResultOptions result{"results/trajectories.csv"};
};

/** \throws io::FileError of what is wrong with the folder */
std::vector<Recording>
readFirstScans(const std::string& folder, std::size_t max_scans)
{
  std::vector<Recording> recordings = readRecordings(folder);
  for (Recording& recording : recordings) {
    if (recording.poses.size() < 2)
      throw io::FileError((std::filesystem::path(folder) / recording.name).string(),
                          "has fewer than two scans");
    recording.poses.resize(std::min(max_scans, recording.poses.size()));
  }
  return recordings;
}

std::vector<RegisteredRecording>
recordingsOf(const TrajectoriesOptions& options, const std::string& folder)
{
  const auto num_scans = static_cast<std::size_t>(options.num_scans);
  std::vector<Recording> real;
  if (!folder.empty())
    real = readFirstScans(folder, num_scans);
  const std::vector<std::string> known = folder.empty() ? driveNames() : namesOf(real);
  io::readOption("recordings", [&] { requireKnown(options.names, known); });
  std::vector<RegisteredRecording> all;
  for (int k = 0; k < options.num_seeds; ++k)
    for (const std::string& name : options.names.empty() ? known : options.names) {
      const auto seed = static_cast<std::uint64_t>(options.first_seed + k);
      all.push_back(
          {folder.empty() ? makeDrive(name, seed, num_scans) : *findNamed(real, name),
           seed,
           {}});
    }
  return all;
}

/** Two scans, and their registrations, one for each method. */
struct PairOfScans {
  int target, source;
  std::vector<EdgeName> names;
};

/** Of the points of each scan. */
std::vector<std::uint64_t>
hashesOf(const Recording& recording, int num_threads)
{
  std::vector<std::uint64_t> hashes(recording.poses.size());
  forEachPiece(hashes.size(), num_threads, [&](std::size_t scan) {
    InputHash hash;
    hash.addMatrix(recording.read(scan));
    hashes[scan] = hash.value();
  });
  return hashes;
}

std::vector<PairOfScans>
scanPairsOf(const RegisteredRecording& registered, const TrajectoriesOptions& options)
{
  const Recording& recording = registered.recording;
  const std::vector<std::uint64_t> hashes = hashesOf(recording, options.num_threads);
  std::vector<PairOfScans> pairs;
  for (const auto& [target, source] :
       pairsOf(recording, options.span, options.closure_distance)) {
    InputHash inputs;
    for (const int scan : {target, source})
      inputs.add(&hashes[std::size_t(scan)], sizeof hashes[0]);
    inputs.addMatrix(guessOf(recording, registered.seed, target, source).matrix());
    PairOfScans pair{target, source, {}};
    for (const std::string& method : edge_methods)
      pair.names.push_back({recording.name,
                            registered.seed,
                            target,
                            source,
                            method,
                            io::textOfHash(inputs.value())});
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

void
registerMissing(const std::vector<PairOfScans>& pairs,
                const RegisteredRecording& registered,
                int num_threads,
                EdgeFile& results)
{
  const auto isMissing = [&](const EdgeName& name) {
    return results.find(name) == nullptr;
  };
  std::vector<PairOfScans> missing;
  for (const PairOfScans& pair : pairs)
    if (std::any_of(pair.names.begin(), pair.names.end(), isMissing))
      missing.push_back(pair);
  const auto run = [&](std::size_t k) {
    const PairOfScans& pair = missing[k];
    const auto read = [&](int scan) {
      return registered.recording.read(static_cast<std::size_t>(scan));
    };
    const Eigen::Matrix3Xd source = read(pair.source), target = read(pair.target);
    const Eigen::Isometry3d guess =
        guessOf(registered.recording, registered.seed, pair.target, pair.source);
    for (const EdgeName& edge : pair.names)
      if (isMissing(edge))
        results.add(registeredEdge(edge, source, target, guess));
  };
  runTasks(missing.size(),
           num_threads,
           "pairs of " + registered.recording.name + ", seed " +
               io::textOf(registered.seed),
           run);
}

/** Register what is not in the file, and take all edges from there. */
void
registerAll(const TrajectoriesOptions& options,
            EdgeFile& results,
            RegisteredRecording& registered)
{
  const std::vector<PairOfScans> pairs = scanPairsOf(registered, options);
  registerMissing(pairs, registered, options.num_threads, results);
  for (const PairOfScans& pair : pairs)
    for (const EdgeName& name : pair.names)
      registered.edges.push_back(*results.find(name));
}

std::string
summaryOf(const std::vector<TrajectoryRun>& runs)
{
  std::vector<GroupedNumbers> numbers;
  for (const TrajectoryRun& run : runs)
    numbers.push_back({run.recording + " (" + run.quality + "), " + run.means + " + " +
                           run.covariances,
                       {static_cast<double>(run.num_edges),
                        milli * run.score.ate,
                        milli * run.score.rpe_translation,
                        app::degrees_per_radian * run.score.rpe_rotation,
                        milli * run.score.drift_translation,
                        run.score.nees_per_degree,
                        run.cycle_nees_per_degree}});
  return summaryText("medians of recording, means + covariances",
                     {{"edges"},
                      {"ATE [mm]"},
                      {"RPE [mm]"},
                      {"RPE [deg]"},
                      {"drift [mm]"},
                      {"NEES/6"},
                      {"cycles"}},
                     numbers);
}

std::string
trajectoriesHelp()
{
  std::string help = R"(Usage: pcl_bayesian_icp_evaluate trajectories [FOLDER] [options]

Do the covariances of registrations make trajectories more accurate, and are
trajectories as accurate as stated? Registers each scan of a recording to those
up to --span before it, and some to earlier scans at the same place. One solver
computes trajectories from the edges: with the means of preset calibrated and
several covariances (its own, a constant one fitted to the other recordings,
the inverse Hessian of GICP, Censi's closed form), and with the means and
covariances of GICP and of point-to-plane ICP.

Without FOLDER, the recordings are simulated drives: )";
  const std::vector<std::string> drives = driveNames();
  for (const std::string& name : drives)
    help += name + (name == drives.back() ? ".\n" : ", ");
  return help + R"(FOLDER contains one folder per recording, with true poses, as for
coverage --real. All methods start at the true pose with errors of 0.1 m and
0.03 rad on each axis. The edge of a registration does not contain this guess
(the closed form keeps its wide prior). The guess is a separate odometry edge
from each scan to the next, the same for all methods.

The summary has medians over the seeds: the error of positions after alignment
(ATE), of relative poses of neighbours (RPE), of the last pose (drift), the
normalised squared error of all poses per degree of freedom (NEES/6) and that
of closures of cycles of up to four edges (1 if covariances are right).
Errors include those of the true poses (exact, or quality A, B, C), and
NEES/6 has their accuracy. Poses of quality C are of the same scans, so they
have no NEES/6. The constant covariance needs other recordings.

Each registration is a row of a second CSV file, FILE_edges.csv, from which an
interrupted study continues. Rows of other scans or other guesses do not count.
A file of another version is refused.

Exit codes: 0 success, 2 usage, 3 a file cannot be read or written.
)";
}

po::options_description
describe(TrajectoriesOptions& options)
{
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("recordings", list(options.names), "only these, separated by commas")
    ("seeds", integer(options.num_seeds, 1, max_seed), "times that each is registered, with other guesses, and other noise of drives")
    ("first-seed", integer(options.first_seed, 0, max_seed), "seed of the first time")
    ("scans", integer(options.num_scans, 2, 100000), "scans of a drive; of a recording at most as many")
    ("span", integer(options.span, 1, 100), "scans before each to which it is registered")
    ("closure-distance", positiveNumber(options.closure_distance),
     "each fifth scan is also registered to the nearest one at least ten before it within this distance [m]")
    ("threads", threads(options.num_threads), "registrations at a time; 0: as many as cores");
  // clang-format on
  addResultOptions(options.result, description, "CSV file of the trajectories");
  return description;
}

std::string
edgeFileName(const std::string& result_file)
{
  std::filesystem::path name = result_file;
  name.replace_filename(name.stem().string() + "_edges.csv");
  return name.string();
}

} // namespace

int
runTrajectoriesCommand(int argc, const char* const* argv)
{
  TrajectoriesOptions options;
  const po::options_description description = describe(options);
  const auto given = readOptions(argc, argv, description, trajectoriesHelp(), "folder");
  const std::vector<std::string> folders = io::optionTexts(given, "folder");
  if (folders.size() > 1)
    throw io::UsageError("one folder of recordings at most");
  std::vector<RegisteredRecording> recordings =
      recordingsOf(options, folders.empty() ? "" : folders[0]);
  io::OutputFolder folder(io::folderOf(options.result.file));
  folder.commit();
  {
    EdgeFile results(edgeFileName(options.result.file));
    for (RegisteredRecording& registered : recordings)
      registerAll(options, results, registered);
  }
  const std::vector<TrajectoryRun> runs = trajectoriesOf(recordings);
  std::string rows = headerOf<TrajectoryRun>() + '\n';
  for (const TrajectoryRun& run : runs)
    rows += rowOf(run) + '\n';
  folder.add(std::filesystem::path(options.result.file).filename().string(), rows);
  folder.commit();
  io::print(summaryOf(runs));
  const auto isConstant = [](const auto& run) { return run.covariances == "constant"; };
  const auto num_constant = std::count_if(runs.begin(), runs.end(), isConstant);
  if (num_constant < 2 * static_cast<std::ptrdiff_t>(recordings.size()))
    std::cerr << "note: rows of a constant covariance are left out where no other "
                 "recording can give it\n";
  return options.result.report();
}

} // namespace bayesian_icp::evaluate
