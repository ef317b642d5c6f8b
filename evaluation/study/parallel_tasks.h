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

/** \brief Do tasks that do not depend on each other, each in one thread.
 * \param[in] run does one; called by several threads at once
 * \param[in] report told of each that is done, by one thread at a time
 * \throws what \p run and \p report throw first; tasks that had not begun then are left
 *         out */
void
runTasks(std::size_t size,
         int num_threads,
         const std::function<void(std::size_t index)>& run,
         const std::function<void(const StudyProgress& progress, std::size_t index)>&
             report);

} // namespace bayesian_icp::evaluate
