/** \file
 * \brief Independent pieces of work on several threads.
 */
#pragma once

#include "threads/first_exception.h"
#include "threads/num_threads.h"

#include <cstddef>

namespace bayesian_icp {

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
