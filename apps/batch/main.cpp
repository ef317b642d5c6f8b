/** \file
 * \brief pcl_bayesian_icp_batch: registers many pairs of clouds.
 */
#include "batch/batch_command.h"
#include "batch/batch_file.h"
#include "batch/batch_line.h"
#include "batch/batch_run.h"
#include "batch/ranks.h"
#include "io/cloud_file.h"
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/program.h"

#include <bayesian_icp/summary.h>

#include <iostream>
#include <optional>

namespace bayesian_icp::app {
namespace {

/** Failures have those of io::explainFailure(). */
enum ExitCode { Good = 0, NotAllOk = 1, Interrupted = io::interrupted_exit_code };

void
tell(const std::string& message)
{
  std::cerr << "pcl_bayesian_icp_batch: " + message + '\n';
}

/** Reports each pair on standard error. */
class ProgressLines {
public:
  ProgressLines(const Ranks& ranks, std::size_t num_pairs, bool is_wanted)
  : start_(ranks.size() > 1 ? "rank " + io::textOf(ranks.rank()) + ": " : "")
  , num_pairs_(num_pairs)
  , is_wanted_(is_wanted)
  {}

  void
  show(const BatchResult& result)
  {
    ++num_done_;
    num_not_ok_ += result.status != toString(Status::Ok) ? 1 : 0;
    if (is_wanted_)
      std::cerr << start_ + io::textOf(num_done_) + '/' + io::textOf(num_pairs_) + ' ' +
                       result.pair.name + ": " + result.status + " (" +
                       io::fixedTextOf(result.seconds, 1) + " s)\n";
  }

  std::size_t
  numNotOk() const
  {
    return num_not_ok_;
  }

private:
  std::string start_;
  std::size_t num_pairs_;
  bool is_wanted_;
  std::size_t num_done_ = 0;
  std::size_t num_not_ok_ = 0;
};

int
exitCodeOf(bool are_all_ok)
{
  return io::wasInterrupted() ? Interrupted : are_all_ok ? Good : NotAllOk;
}

BatchRunOptions
runOptionsOf(const BatchRequest& request)
{
  return {request.settings.options.chains.num_threads, request.output_folder};
}

int
runToStandardOutput(const BatchRequest& request,
                    const Ranks& ranks,
                    const std::vector<BatchPair>& pairs)
{
  ProgressLines progress(ranks, pairs.size(), !request.is_quiet);
  runBatch(pairs, runOptionsOf(request), [&](const BatchResult& result) {
    io::print(batchLine(result) + '\n');
    progress.show(result);
  });
  return exitCodeOf(progress.numNotOk() == 0);
}

/** This process's part of the pairs at \p positions ("3 5 9 ..."). */
std::vector<BatchPair>
shareOf(const Ranks& ranks,
        const std::string& positions,
        const std::vector<BatchPair>& pairs)
{
  std::vector<BatchPair> share;
  int turn = 0;
  for (const std::string_view word : io::words(positions)) {
    std::size_t position = 0;
    io::readNumber(word, position);
    if (turn++ % ranks.size() == ranks.rank())
      share.push_back(pairs.at(position));
  }
  return share;
}

/** Process 0 owns the file; the others write theirs, which it takes in at the end. */
int
runToFile(const BatchRequest& request,
          const Ranks& ranks,
          const std::vector<BatchPair>& pairs)
{
  std::optional<BatchFile> file;
  std::string positions;
  if (ranks.rank() == 0) {
    file.emplace(request.results_file, pairs);
    for (const std::size_t position : file->remaining())
      positions += io::textOf(position) + ' ';
    if (file->numFinished() > 0 && !request.is_quiet)
      tell(io::textOf(file->numFinished()) + " of " + io::textOf(pairs.size()) +
           " pairs already have a line in " + request.results_file);
  }
  const auto share = shareOf(ranks, ranks.broadcast(positions), pairs);
  std::optional<io::LineFile> part;
  if (ranks.rank() > 0)
    part.emplace(rankFileName(request.results_file, ranks.rank()),
                 [](const std::string&) {});
  ProgressLines progress(ranks, share.size(), !request.is_quiet);
  runBatch(share, runOptionsOf(request), [&](const BatchResult& result) {
    if (file)
      file->add(batchLine(result));
    else
      part->add(batchLine(result));
    progress.show(result);
  });
  part.reset();
  ranks.maximum(0); // All have written their parts.
  if (file)
    file->takeRankFiles();
  return ranks.maximum(exitCodeOf(!file || file->numNotOk() == 0));
}

int
runTool(int argc, char** argv, const Ranks& ranks)
{
  const std::optional<BatchRequest> asked = parseBatchCommand(argc, argv);
  if (!asked)
    return Good;
  const BatchRequest& request = *asked;
  if (!request.note.empty() && !request.is_quiet && ranks.rank() == 0)
    tell("note: " + request.note);
  if (ranks.size() > 1 && request.results_file.empty())
    throw io::UsageError("several processes need --results");
  io::silencePcl();
  const auto pairs = readManifest(
      request.manifest_file, request.settings, request.use_suggested_prior);
  io::catchInterrupt();
  return request.results_file.empty() ? runToStandardOutput(request, ranks, pairs)
                                      : runToFile(request, ranks, pairs);
}

} // namespace
} // namespace bayesian_icp::app

int
main(int argc, char** argv)
{
  using namespace bayesian_icp::app;
  const Ranks ranks;
  bayesian_icp::io::takeSizeLimitAsFullDisk();
  try {
    return runTool(argc, argv, ranks);
  }
  catch (...) {
    const int exit_code = bayesian_icp::io::explainFailure("pcl_bayesian_icp_batch");
    ranks.abort(exit_code);
    return exit_code;
  }
}
