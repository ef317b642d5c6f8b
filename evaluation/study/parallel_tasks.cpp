#include "study/parallel_tasks.h"

#include "threads/first_exception.h"

#include <chrono>

namespace bayesian_icp::evaluate {

void
runTasks(const StudyTasks& tasks, int num_threads)
{
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  std::size_t num_done = 0;
  FirstException failure;
#pragma omp parallel for schedule(dynamic) num_threads(num_threads)
  for (std::size_t i = 0; i < tasks.size; ++i)
    // No exception may leave a parallel region or a critical section.
    failure.guard([&] {
      tasks.run(i);
#pragma omp critical(study_tasks)
      failure.guard([&] {
        ++num_done;
        const double seconds =
            std::chrono::duration<double>(Clock::now() - begin).count();
        const auto num_left = static_cast<double>(tasks.size - num_done);
        if (tasks.report)
          tasks.report({num_done,
                        tasks.size,
                        seconds * num_left / static_cast<double>(num_done)},
                       i);
      });
    });
  failure.rethrow();
}

} // namespace bayesian_icp::evaluate
