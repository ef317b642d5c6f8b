/** \file
 * \brief An exception on its way out of a parallel region, which none may leave.
 */
#pragma once

#include <atomic>
#include <exception>
#include <mutex>

namespace bayesian_icp {

/** \brief Keeps the first exception of several threads for the one that started them.
 */
class FirstException {
public:
  /** \brief Run \p work and keep what it throws; do nothing once something was thrown.
   * \return whether \p work was run to its end */
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

  /** \brief After the parallel region: throw what was kept, if anything was. */
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
