#include "study/parallel_tasks.h"

#include "io/clocks.h"
#include "threads/for_each_piece.h"

#include <mutex>

namespace bayesian_icp::evaluate {

void
runTasks(
    std::size_t size,
    int num_threads,
    const std::function<void(std::size_t index)>& run,
    const std::function<void(const StudyProgress& progress, std::size_t index)>& report)
{
  const double begin = io::wallSeconds();
  std::size_t num_done = 0;
  std::mutex mutex;
  forEachPiece(size, num_threads, [&](std::size_t i) {
    run(i);
    const std::lock_guard<std::mutex> lock(mutex);
    ++num_done;
    const double seconds_each =
        (io::wallSeconds() - begin) / static_cast<double>(num_done);
    report({num_done, size, seconds_each * static_cast<double>(size - num_done)}, i);
  });
}

} // namespace bayesian_icp::evaluate
