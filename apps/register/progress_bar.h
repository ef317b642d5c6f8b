/** \file
 * \brief A progress bar on the terminal.
 */
#pragma once

#include "register/run.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace bayesian_icp::app {

/** \brief Shows what is going on, on standard error if that is a terminal, and only if
 * the run lasts over two seconds. Leaves nothing on the screen when it goes. */
class ProgressBar {
public:
  /** \brief The run begins now, with ICP. A bar that is not wanted never shows.
   * \param[in] activity what the steps are doing */
  explicit ProgressBar(bool is_wanted, const char* activity = "sampling");
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar&
  operator=(const ProgressBar&) = delete;

  /** \brief The chains have come so far. */
  void
  update(const Progress& progress);

private:
  void
  drawUntilStopped();

  void
  draw() const;

  const char* activity_;
  std::atomic<bool> has_icp_finished_{false};
  std::atomic<long> steps_{0};
  std::atomic<long> total_steps_{0};
  bool is_stopped_ = false;
  std::mutex mutex_;
  std::condition_variable stop_;
  std::thread thread_;
};

/** \brief Register the clouds of \p run until it is done or interrupted, with a bar if
 * that is wanted. */
void
registerWithBar(bool is_wanted, Run& run);

} // namespace bayesian_icp::app
