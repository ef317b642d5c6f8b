/** \file
 * \brief The tasks of a study, several at a time.
 */
#pragma once

#include <cstddef>
#include <functional>

namespace bayesian_icp::evaluate {

/** \brief How far a study is. */
struct StudyProgress {
  std::size_t num_done;
  std::size_t num_all;
  double seconds_left;
};

/** \brief Tasks that do not depend on each other, by their index. */
struct StudyTasks {
  std::size_t size = 0;
  /** Does one; called by several threads at once. */
  std::function<void(std::size_t index)> run;
  /** Told of each that is done, by one thread at a time; may be empty. */
  std::function<void(const StudyProgress& progress, std::size_t index)> report;
};

/** \brief Do all tasks, each in one thread.
 * \throws what `run` and `report` throw first; tasks that had not begun then are left
 *         out */
void
runTasks(const StudyTasks& tasks, int num_threads);

} // namespace bayesian_icp::evaluate
