#include "batch/batch_run.h"

#include "io/clocks.h"
#include "io/interrupt.h"
#include "io/motion.h"
#include "register/posterior_files.h"
#include "threads/first_exception.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

namespace bayesian_icp::app {

namespace {

/** What the threads of a batch share. */
class Batch {
public:
  Batch(const std::vector<BatchPair>& pairs,
        const std::string& output_folder,
        const std::function<void(const BatchResult&)>& take)
  : pairs_(pairs)
  , output_folder_(output_folder)
  , take_(take)
  {}

  /** Register pairs until none is left. */
  void
  work()
  {
    for (std::size_t i = next_++; i < pairs_.size() && !isStopped(); i = next_++)
      failure_.guard([&] { handle(pairs_[i]); });
  }

  /** \throws what one of the threads has met */
  void
  rethrow() const
  {
    failure_.rethrow();
  }

private:
  bool
  isStopped() const
  {
    return failure_.isThere() || io::wasInterrupted();
  }

  Run
  registerPair(const BatchPair& pair) const
  {
    Settings settings = pair.settings;
    if (!pair.guess_file.empty())
      settings.guess = io::readMotionFile(pair.guess_file);
    Run run = readRun(pair.source_file, pair.target_file, settings);
    run.result = registerClouds(run.source.points,
                                run.target.points,
                                run.settings,
                                [this](const Progress&) { return !isStopped(); });
    return run;
  }

  void
  handle(const BatchPair& pair)
  {
    const double start = io::wallSeconds();
    const std::string state = pair.filesState();
    std::optional<Run> run;
    std::string complaint;
    try {
      run = registerPair(pair);
    }
    catch (const std::bad_alloc&) {
      complaint = "out of memory";
    }
    catch (const std::exception& error) {
      complaint = error.what();
    }
    BatchResult result{
        pair, nullptr, error_status, complaint, io::wallSeconds() - start, state};
    if (run) {
      const Summary& summary = run->result.summary;
      if (summary.status == Status::Cancelled)
        return;
      result.run = &*run;
      result.status = toString(summary.status);
      result.message = summary.message;
    }
    if (!output_folder_.empty())
      putFiles(result);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_.isThere())
      take_(result);
  }

  /** Nothing of an older result stays where a pair cannot be registered. */
  void
  putFiles(const BatchResult& result) const
  {
    const auto path = std::filesystem::path(output_folder_) / result.pair.name;
    std::error_code error;
    if (result.run == nullptr && !std::filesystem::exists(path, error))
      return;
    io::OutputFolder files(path.string());
    if (result.run != nullptr)
      addPosteriorFiles(*result.run, files);
    else
      for (const char* const name : {"posterior.json", "samples.csv"})
        files.leaveOut(name);
    files.commit();
  }

  const std::vector<BatchPair>& pairs_;
  const std::string& output_folder_;
  const std::function<void(const BatchResult&)>& take_;
  std::atomic<std::size_t> next_{0};
  FirstException failure_;
  std::mutex mutex_;
};

} // namespace

void
runBatch(const std::vector<BatchPair>& pairs,
         int num_threads,
         const std::string& output_folder,
         const std::function<void(const BatchResult&)>& take)
{
  if (pairs.empty())
    return;
  if (num_threads <= 0)
    num_threads = omp_get_max_threads();
  const int num_workers =
      static_cast<int>(std::min(pairs.size(), static_cast<std::size_t>(num_threads)));
  Batch batch(pairs, output_folder, take);
  const auto workAs = [&batch, num_threads, num_workers](int worker) {
    omp_set_num_threads(num_threads / num_workers +
                        (worker < num_threads % num_workers ? 1 : 0));
    batch.work();
  };
  std::vector<std::thread> others;
  try {
    for (int i = 1; i < num_workers; ++i)
      others.emplace_back(workAs, i);
  }
  catch (const std::exception&) {
    // No more threads, or no memory for them: those that there are do it all.
  }
  const int usual_num_threads = omp_get_max_threads();
  workAs(0);
  omp_set_num_threads(usual_num_threads);
  for (std::thread& other : others)
    other.join();
  batch.rethrow();
}

} // namespace bayesian_icp::app
