#include "job.h"

#include <cxxabi.h>
#include <pybind11/eigen.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

/** How often signals are looked for. */
constexpr std::chrono::milliseconds period(50);

/** How long a run may take to end that nobody waits for any more. Its thread ends by
 * itself: among millions of points that takes seconds. */
constexpr std::chrono::milliseconds patience(300);

/** What the two threads share; the lock guards it. */
struct Job {
  std::mutex lock;
  bool is_cancelled = false;
  Progress progress = {0, 0, 0, 0};
};

void
cancel(Job& job)
{
  const std::lock_guard<std::mutex> guard(job.lock);
  job.is_cancelled = true;
}

bool
hasEndedWithin(std::chrono::milliseconds time,
               const std::future<PosteriorEstimate>& result)
{
  PyThreadState* const state = PyEval_SaveThread();
  const bool has_ended = result.wait_for(time) == std::future_status::ready;
  try {
    PyEval_RestoreThread(state);
  }
  catch (abi::__forced_unwind&) {
    // Python ends, and this daemon thread with it: no destructor may run without it.
    for (;;)
      pause();
  }
  return has_ended;
}

/** \return whether the observer lets it go on */
bool
tell(const py::object& observer, const Progress& state)
{
  if (observer.is_none())
    return true;
  const py::object answer = observer(state.steps, state.total_steps, state.pose);
  try {
    return answer.is_none() || answer.cast<bool>();
  }
  catch (const py::cast_error&) {
    throw py::type_error("progress returned " + std::string(py::repr(answer)) +
                         ", but must return True, False or None");
  }
}

/** Waits for the work, and passes on signals and progress meanwhile. */
void
watch(const std::future<PosteriorEstimate>& result,
      Job& job,
      const py::object& observer)
{
  try {
    for (bool has_ended = false; !has_ended;) {
      has_ended = hasEndedWithin(period, result);
      if (PyErr_CheckSignals() != 0)
        throw py::error_already_set();
      std::unique_lock<std::mutex> guard(job.lock);
      const Progress state = job.progress;
      guard.unlock();
      if (!tell(observer, state))
        cancel(job);
    }
  }
  catch (...) {
    cancel(job);
    hasEndedWithin(patience, result);
    throw;
  }
}

} // namespace

PosteriorEstimate
runBeside(const Work& work, const py::object& observer)
{
  const auto job = std::make_shared<Job>();
  std::packaged_task<PosteriorEstimate()> task([job, work] {
    return work([&job = *job](const Progress& state) {
      const std::lock_guard<std::mutex> guard(job.lock);
      job.progress = state;
      return !job.is_cancelled;
    });
  });
  std::future<PosteriorEstimate> result = task.get_future();
  std::thread(std::move(task)).detach();
  watch(result, *job, observer);
  return result.get();
}

} // namespace bayesian_icp::python
