#include "job.h"

#include <pybind11/eigen.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

/** How often signals are looked for. */
constexpr std::chrono::milliseconds period(50);

/** How long a run may take to end that nobody waits for any more. Its thread ends by
 * itself: among millions of points that takes seconds. */
constexpr std::chrono::milliseconds patience(300);

/** What the two threads share; the lock guards all of it. */
struct Job {
  std::mutex lock;
  std::condition_variable ended;
  bool has_ended = false;
  bool is_cancelled = false;
  Progress progress = {0, 0, 0, 0};
  PosteriorEstimate estimate;
  std::exception_ptr failure;

  bool
  keep(const Progress& state)
  {
    const std::lock_guard<std::mutex> guard(lock);
    progress = state;
    return !is_cancelled;
  }

  void
  run(const Work& work)
  {
    PosteriorEstimate found;
    std::exception_ptr error;
    try {
      found = work([this](const Progress& state) { return keep(state); });
    }
    catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard<std::mutex> guard(lock);
    estimate = std::move(found);
    failure = error;
    has_ended = true;
    ended.notify_all();
  }

  void
  cancel()
  {
    const std::lock_guard<std::mutex> guard(lock);
    is_cancelled = true;
  }

  /** \return whether the work has ended */
  bool
  wait(std::chrono::milliseconds time, Progress& state)
  {
    const py::gil_scoped_release release;
    std::unique_lock<std::mutex> guard(lock);
    ended.wait_for(guard, time, [this] { return has_ended; });
    state = progress;
    return has_ended;
  }
};

/** \return whether the observer lets it go on */
bool
tell(const py::object& observer, const Progress& state)
{
  if (observer.is_none())
    return true;
  const py::object answer = observer(state.steps, state.total_steps, state.pose);
  return answer.is_none() || answer.cast<bool>();
}

/** Waits for the work, and passes on signals and progress meanwhile. */
void
watch(Job& job, const py::object& observer)
{
  Progress state = {0, 0, 0, 0};
  bool has_ended = false;
  try {
    while (!has_ended) {
      has_ended = job.wait(period, state);
      if (PyErr_CheckSignals() != 0)
        throw py::error_already_set();
      if (!tell(observer, state))
        job.cancel();
    }
  }
  catch (...) {
    job.cancel();
    job.wait(patience, state);
    throw;
  }
}

} // namespace

PosteriorEstimate
runBeside(const Work& work, const py::object& observer)
{
  const auto job = std::make_shared<Job>();
  std::thread([job, work] { job->run(work); }).detach();
  watch(*job, observer);
  if (job->failure)
    std::rethrow_exception(job->failure);
  return std::move(job->estimate);
}

} // namespace bayesian_icp::python
