/** \file
 * \brief Carries an exception out of a parallel region, which no exception may leave by
 * itself.
 */
#pragma once

#include <atomic>
#include <exception>
#include <mutex>

namespace bayesian_icp {

/** \brief Keeps the first exception of several threads, for the thread that started
 * them. */
class FirstException {
public:
  /** \brief Run \p work and keep the exception that it throws. Does nothing after an
   * exception.
   * \return whether \p work ran to its end */
  template <typename Work>
  bool
  guard(const Work& work)
  {
    if (is_there_)
      return false;
    try {
      work();
      return true;
    }
    catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!is_there_)
        exception_ = std::current_exception();
      is_there_ = true;
      return false;
    }
  }

  /** \brief Whether there was an exception. */
  bool
  isThere() const
  {
    return is_there_;
  }

  /** \brief Throw the exception that was kept, if any. Call this after the parallel
   * region. */
  void
  rethrow() const
  {
    if (exception_)
      std::rethrow_exception(exception_);
  }

private:
  std::atomic<bool> is_there_{false};
  std::exception_ptr exception_;
  std::mutex mutex_;
};

} // namespace bayesian_icp
