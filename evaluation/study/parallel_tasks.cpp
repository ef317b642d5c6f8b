#include "study/parallel_tasks.h"

#include "io/clocks.h"
#include "threads/first_exception.h"

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
  FirstException failure;
#pragma omp parallel for schedule(dynamic) num_threads(num_threads)
  for (std::size_t i = 0; i < size; ++i)
    // No exception may leave a parallel region or a critical section.
    failure.guard([&] {
      run(i);
#pragma omp critical(study_tasks)
      failure.guard([&] {
        ++num_done;
        const double seconds_each =
            (io::wallSeconds() - begin) / static_cast<double>(num_done);
        if (report)
          report({num_done, size, seconds_each * static_cast<double>(size - num_done)},
                 i);
      });
    });
  failure.rethrow();
}

} // namespace bayesian_icp::evaluate
