#include "batch/ranks.h"

// The C functions only.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace bayesian_icp::app {

namespace {

/** Started by hand, MPI would only be slow to begin and may be set up badly. */
bool
isStartedByLauncher()
{
  for (const char* const variable :
       {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"})
    if (std::getenv(variable) != nullptr)
      return true;
  return false;
}

/** MPI's own waiting keeps a processor busy that other processes could use. */
void
await(MPI_Request request)
{
  int is_done = 0;
  while (MPI_Test(&request, &is_done, MPI_STATUS_IGNORE) == MPI_SUCCESS && is_done == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

} // namespace

Ranks::Ranks()
{
  if (!isStartedByLauncher())
    return;
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Ranks::~Ranks()
{
  int is_initialized = 0;
  MPI_Initialized(&is_initialized);
  if (is_initialized != 0)
    MPI_Finalize();
}

bool
Ranks::hasMpi()
{
  return true;
}

std::vector<std::size_t>
Ranks::broadcast(std::vector<std::size_t> numbers) const
{
  static_assert(sizeof(std::size_t) == sizeof(unsigned long));
  if (size_ == 1)
    return numbers;
  MPI_Request request;
  int count = static_cast<int>(numbers.size());
  MPI_Ibcast(&count, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
  await(request);
  numbers.resize(static_cast<std::size_t>(count));
  MPI_Ibcast(numbers.data(), count, MPI_UNSIGNED_LONG, 0, MPI_COMM_WORLD, &request);
  await(request);
  return numbers;
}

int
Ranks::maximum(int value) const
{
  int largest = value;
  if (size_ == 1)
    return largest;
  MPI_Request request;
  MPI_Iallreduce(&value, &largest, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
  await(request);
  return largest;
}

void
Ranks::abort(int exit_code) const
{
  if (size_ > 1)
    MPI_Abort(MPI_COMM_WORLD, exit_code);
}

} // namespace bayesian_icp::app
