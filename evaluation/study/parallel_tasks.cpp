#include "study/parallel_tasks.h"

#include "io/clocks.h"
#include "study/text_table.h"
#include "threads/for_each_piece.h"

#include <iostream>
#include <mutex>

namespace bayesian_icp::evaluate {

std::string
progressText(std::size_t num_done,
             std::size_t size,
             const std::string& tasks,
             double seconds_each)
{
  return format("%zu of %zu %s, about %.0f s left",
                num_done,
                size,
                tasks.c_str(),
                seconds_each * static_cast<double>(size - num_done));
}

void
runTasks(std::size_t size,
         int num_threads,
         const std::string& tasks,
         const std::function<void(std::size_t index)>& run)
{
  const double begin = io::wallSeconds();
  std::size_t num_done = 0;
  std::mutex mutex;
  forEachPiece(size, num_threads, [&](std::size_t i) {
    run(i);
    const std::lock_guard<std::mutex> lock(mutex);
    ++num_done;
    if (num_done * 100 / size == (num_done - 1) * 100 / size)
      return;
    const double seconds_each =
        (io::wallSeconds() - begin) / static_cast<double>(num_done);
    std::cerr << progressText(num_done, size, tasks, seconds_each) << std::endl;
  });
}

} // namespace bayesian_icp::evaluate
