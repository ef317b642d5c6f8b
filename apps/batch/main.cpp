/** \file
 * \brief pcl_bayesian_icp_batch: registers many pairs of clouds.
 */
#include "batch/batch_file.h"
#include "batch/batch_run.h"
#include "batch/ranks.h"
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "register/settings_options.h"

#include <bayesian_icp/summary.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>

namespace bayesian_icp::app {
namespace {

namespace po = boost::program_options;

/** What the user asks for. */
struct Request {
  std::string manifest_file;
  /** Empty for standard output. */
  std::string results_file;
  /** Empty if no files of single pairs are wanted. */
  std::string output_folder;
  bool use_suggested_prior = false;
  bool is_quiet = false;
  /** Of pairs that say nothing else. */
  Settings settings;
};

po::options_description
describeOptions(Request& request)
{
  po::options_description group = io::generalOptions();
  // clang-format off
  group.add_options()
    ("results", io::fileName("FILE", request.results_file),
     "Write the lines to this file, and skip pairs that already have a line in it, "
     "unless their files have changed. (default: standard output)")
    ("output,o", io::fileName("DIR", request.output_folder),
     "Write DIR/NAME/posterior.json and samples.csv for each pair that has no line yet. "
     "Without it, only the lines are written.")
    ("suggested-prior", io::flag(request.use_suggested_prior),
     "Use a prior about the guess and the source's centroid, with the standard "
     "deviations 'suggested_prior_sigma' of each pair. Without it, all pairs have the "
     "prior of --prior-mean and --prior-variance.")
    ("quiet", io::flag(request.is_quiet), "Show no progress.");
  // clang-format on
  po::options_description all;
  all.add(group);
  describeSettings(all);
  return all;
}

io::ToolText
toolText()
{
  return {std::string("pcl_bayesian_icp_batch " BAYESIAN_ICP_VERSION) +
              (Ranks::hasMpi() ? " with MPI" : " without MPI"),
          R"(Usage: pcl_bayesian_icp_batch MANIFEST [options]
       mpirun -n N pcl_bayesian_icp_batch MANIFEST --results FILE [options]

Registers many pairs of clouds in parallel. Prints one line of JSON for each
pair as soon as the pair is finished. MANIFEST is a JSON list of pairs,
  {"name": ..., "source": FILE, "target": FILE, "guess": FILE or six numbers,
   "settings": {...}}
whose files are relative to the manifest. Guess and settings are optional. The
settings have the form of the 'options' of a posterior.json. They take
precedence over the options below, which apply to all pairs. --threads is the
number of threads of the whole process: each pair has one thread if there are
more pairs than threads. docs/batch.md describes the keys of a line.

A batch that was stopped continues if it is started again with the same
--results. If the size or modification time of a pair's file has changed since it
was read, the pair loses its line and is registered again. If a pair cannot be
read or registered, its line has the status "error", and the other pairs continue.
)",
          R"(
Exit codes:
  0    the status of all pairs is "ok"
  1    the status of some pairs is not "ok"
  2    wrong usage
  3    the manifest cannot be used, or a result cannot be written
  130  interrupted (Ctrl-C or SIGTERM); unfinished pairs were abandoned

Example:
  pcl_bayesian_icp_batch manifest.json --results results.jsonl \
      --prior-variance 0.01
)"};
}

/** As io::readCommandLine(), and reads the configuration file that it names. */
Request
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, "manifest", toolText());
  const std::vector<std::string> manifests = io::optionTexts(given, "manifest");
  if (manifests.empty())
    throw io::UsageError("expected a manifest");
  if (manifests.size() > 1)
    throw io::UsageError("expected one manifest, but got a second file: " +
                         io::inQuotes(manifests[1]));
  request.manifest_file = manifests[0];
  io::takeOptions(given, options);
  if (request.use_suggested_prior)
    io::refuseOptions(given,
                      {"prior-mean", "prior-variance", "prior-frame"},
                      " and --suggested-prior exclude each other");
  request.settings = settingsFrom(given);
  return request;
}

int
exitCodeOf(bool are_all_ok)
{
  return io::wasInterrupted() ? io::Interrupted : are_all_ok ? io::Good : io::NotGood;
}

/** Registers \p pairs, passes each result on to \p take, and reports it on standard
 * error. */
void
registerPairs(const Request& request,
              const Ranks& ranks,
              const std::vector<BatchPair>& pairs,
              const std::function<void(const BatchResult&)>& take)
{
  const std::string start =
      ranks.size() > 1 ? "rank " + io::textOf(ranks.rank()) + ": " : "";
  std::size_t num_done = 0;
  runBatch(pairs,
           request.settings.options.chains.num_threads,
           request.output_folder,
           [&](const BatchResult& result) {
             take(result);
             ++num_done;
             if (!request.is_quiet)
               std::cerr << start + io::textOf(num_done) + '/' +
                                io::textOf(pairs.size()) + ' ' + result.pair.name +
                                ": " + result.status + " (" +
                                io::fixedTextOf(result.seconds, 1) + " s)\n";
           });
}

int
runToStandardOutput(const Request& request,
                    const Ranks& ranks,
                    const std::vector<BatchPair>& pairs)
{
  bool are_all_ok = true;
  registerPairs(request, ranks, pairs, [&](const BatchResult& result) {
    io::print(batchLine(result) + '\n');
    are_all_ok &= result.status == toString(Status::Ok);
  });
  return exitCodeOf(are_all_ok);
}

/** This process's part of the pairs at \p positions. */
std::vector<BatchPair>
shareOf(const Ranks& ranks,
        const std::vector<std::size_t>& positions,
        const std::vector<BatchPair>& pairs)
{
  std::vector<BatchPair> share;
  for (auto i = static_cast<std::size_t>(ranks.rank()); i < positions.size();
       i += static_cast<std::size_t>(ranks.size()))
    share.push_back(pairs.at(positions[i]));
  return share;
}

/** Pairs that have a line from a run without --output are not registered again for
 * their files. */
void
tellMissingFiles(const Request& request,
                 const std::vector<BatchPair>& pairs,
                 const std::vector<std::size_t>& registered)
{
  if (request.output_folder.empty())
    return;
  std::error_code error;
  const auto num_missing =
      std::count_if(registered.begin(), registered.end(), [&](std::size_t k) {
        return !std::filesystem::exists(std::filesystem::path(request.output_folder) /
                                            pairs[k].name / "posterior.json",
                                        error);
      });
  if (num_missing > 0)
    io::tell(io::textOf(num_missing) + " pairs have a line in " + request.results_file +
             " but no files in " + request.output_folder +
             ", and are not run again; docs/batch.md says how to");
}

/** Process 0 owns the file; the others write theirs, which it takes in at the end. */
int
runToFile(const Request& request,
          const Ranks& ranks,
          const std::vector<BatchPair>& pairs)
{
  std::optional<BatchFile> file;
  std::vector<std::size_t> positions;
  if (ranks.rank() == 0) {
    file.emplace(request.results_file, pairs);
    positions = file->remaining();
    const std::size_t num_finished = pairs.size() - positions.size();
    if (num_finished > 0 && !request.is_quiet)
      io::tell(io::textOf(num_finished) + " of " + io::textOf(pairs.size()) +
               " pairs already have a line in " + request.results_file);
    if (file->numChanged() > 0)
      io::tell(io::textOf(file->numChanged()) +
               " pairs are registered again, because their files have changed");
    tellMissingFiles(request, pairs, file->registered());
  }
  const auto share = shareOf(ranks, ranks.broadcast(positions), pairs);
  std::optional<io::LineFile> part;
  if (ranks.rank() > 0)
    part.emplace(rankFileName(request.results_file, ranks.rank()),
                 [](const std::string&) { return true; });
  registerPairs(request, ranks, share, [&](const BatchResult& result) {
    if (file)
      file->add(batchLine(result));
    else
      part->add(batchLine(result));
  });
  part.reset();
  ranks.maximum(0); // All have written their parts.
  if (file)
    file->takeRankFiles();
  return ranks.maximum(exitCodeOf(!file || file->areAllOk()));
}

int
runTool(int argc, char** argv, const Ranks& ranks)
{
  const Request request = parseCommandLine(argc, argv);
  if (!request.settings.note.empty() && !request.is_quiet && ranks.rank() == 0)
    io::tell("note: " + request.settings.note);
  if (ranks.size() > 1 && request.results_file.empty())
    throw io::UsageError("several processes need --results");
  io::silencePcl();
  const auto pairs = readManifest(
      request.manifest_file, request.settings, request.use_suggested_prior);
  if (!request.output_folder.empty()) {
    io::makeFolder(request.output_folder);
    const io::OutputFolder probe(request.output_folder);
  }
  io::catchInterrupt();
  const int exit_code = request.results_file.empty()
                            ? runToStandardOutput(request, ranks, pairs)
                            : runToFile(request, ranks, pairs);
  if (exit_code == io::Interrupted && ranks.rank() == 0)
    io::tell("interrupted; the pairs under way are abandoned");
  return exit_code;
}

} // namespace
} // namespace bayesian_icp::app

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  const app::Ranks ranks;
  return io::runProgram(
      "pcl_bayesian_icp_batch",
      [&] { return app::runTool(argc, argv, ranks); },
      [&](int exit_code) { ranks.abort(exit_code); });
}
