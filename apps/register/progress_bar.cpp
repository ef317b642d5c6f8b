#include "register/progress_bar.h"

#include "io/interrupt.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace bayesian_icp::app {

namespace {

constexpr std::chrono::milliseconds delay_before_first(2000);
constexpr std::chrono::milliseconds delay_between(100);
constexpr long bar_width = 50;

} // namespace

ProgressBar::ProgressBar(bool is_wanted, const char* activity) : activity_(activity)
{
  if (is_wanted && isatty(STDERR_FILENO) != 0)
    thread_ = std::thread([this] { drawUntilStopped(); });
}

ProgressBar::~ProgressBar()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_stopped_ = true;
  }
  stop_.notify_all();
  if (thread_.joinable())
    thread_.join();
}

void
ProgressBar::update(const Progress& progress)
{
  has_icp_finished_ = true;
  total_steps_ = progress.total_steps;
  steps_ = progress.steps;
}

void
ProgressBar::drawUntilStopped()
{
  std::unique_lock<std::mutex> lock(mutex_);
  const auto isStopped = [this] { return is_stopped_; };
  if (stop_.wait_for(lock, delay_before_first, isStopped))
    return;
  do
    draw();
  while (!stop_.wait_for(lock, delay_between, isStopped));
  std::fputs("\r\033[K", stderr);
}

void
ProgressBar::draw() const
{
  const long steps = steps_;
  if (steps == 0) {
    std::fputs(has_icp_finished_ ? "\rwarming up ..." : "\rICP ...", stderr);
  }
  else {
    const auto done = static_cast<std::size_t>(bar_width * steps / total_steps_);
    const std::string bar = std::string(done, '#') + std::string(bar_width - done, '.');
    const long percent = 100 * steps / total_steps_;
    std::fprintf(stderr, "\r%s [%s] %3ld %%", activity_, bar.c_str(), percent);
  }
  std::fflush(stderr);
}

void
registerWithBar(bool is_wanted, Run& run)
{
  ProgressBar bar(is_wanted);
  run.result = registerClouds(run.source.points,
                              run.target.points,
                              run.settings,
                              [&bar](const Progress& progress) {
                                bar.update(progress);
                                return !io::wasInterrupted();
                              });
}

} // namespace bayesian_icp::app
