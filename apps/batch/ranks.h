/** \file
 * \brief The processes that share a batch: one, or those that mpirun has started.
 */
#pragma once

#include <cstddef>
#include <vector>

namespace bayesian_icp::app {

/** \brief This process among those of the same run. Without MPI, or without mpirun,
 * it is alone. Waiting does not keep a processor busy. */
class Ranks {
public:
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks&
  operator=(const Ranks&) = delete;

  /** \brief Whether the program has been built with MPI. */
  static bool
  hasMpi();

  /** \brief Number of this process, from 0 on. */
  int
  rank() const
  {
    return rank_;
  }

  /** \brief Number of processes. */
  int
  size() const
  {
    return size_;
  }

  /** \brief The \p numbers of process 0, in all processes. */
  std::vector<std::size_t>
  broadcast(std::vector<std::size_t> numbers) const;

  /** \brief The largest \p value of all processes, in all processes, when all have come
   * here. */
  int
  maximum(int value) const;

  /** \brief End all processes if there are others, which may be waiting for this one.
   */
  void
  abort(int exit_code) const;

private:
  int rank_ = 0;
  int size_ = 1;
};

} // namespace bayesian_icp::app
