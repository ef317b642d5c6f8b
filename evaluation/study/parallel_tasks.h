/** \file
 * \brief The tasks of a study, several at a time.
 */
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief A line of progress: how many tasks are done, and about how long the others
 * take.
 * \param[in] tasks what they are ("pairs")
 * \param[in] seconds_each of a task */
std::string
progressText(std::size_t num_done,
             std::size_t size,
             const std::string& tasks,
             double seconds_each);

/** \brief Do tasks that do not depend on each other, each in one thread, and tell the
 * standard error how many are done: each of them, or each hundredth part.
 * \param[in] tasks as in progressText()
 * \param[in] run does one; called by several threads at once
 * \throws what \p run throws first; tasks that had not begun then are left out */
void
runTasks(std::size_t size,
         int num_threads,
         const std::string& tasks,
         const std::function<void(std::size_t index)>& run);

} // namespace bayesian_icp::evaluate
