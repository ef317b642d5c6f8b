/** \file
 * \brief Independent pieces of work on several threads.
 */
#pragma once

#include "threads/first_exception.h"

#include <omp.h>

#include <algorithm>
#include <cstddef>

namespace bayesian_icp {

/** \brief Largest number of threads. If there is not enough memory for the requested
 * number, OpenMP ends the program. */
constexpr int max_num_threads = 1024;

/** \brief Threads for a number of pieces of work: one inside a parallel region of
 * the caller.
 * \param[in] num_threads as asked for, 0: as OpenMP would
 * \param[in] num_pieces may be 0 */
inline int
numThreadsFor(int num_threads, std::ptrdiff_t num_pieces)
{
  if (omp_in_parallel() != 0)
    return 1;
  const int offered =
      std::min(num_threads > 0 ? num_threads : omp_get_max_threads(), max_num_threads);
  return static_cast<int>(
      std::max<std::ptrdiff_t>(1, std::min<std::ptrdiff_t>(offered, num_pieces)));
}

/** \brief Call work(i) for i = 0 ... num_pieces - 1, in any order. A piece must write
 * only what no other piece reads or writes. Rethrows the first exception.
 * \param[in] num_threads 0: as OpenMP would */
template <typename Count, typename Work>
void
forEachPiece(Count num_pieces, int num_threads, const Work& work)
{
  FirstException failure;
  const int num_used =
      numThreadsFor(num_threads, static_cast<std::ptrdiff_t>(num_pieces));
#pragma omp parallel for num_threads(num_used) schedule(dynamic, 1)
  for (Count i = 0; i < num_pieces; ++i)
    failure.guard([&] { work(i); });
  failure.rethrow();
}

} // namespace bayesian_icp
