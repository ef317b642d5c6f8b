/** \file
 * \brief Does what a sanitizer must report, to see that it would. Argument: race,
 * buffer, leak or overflow.
 */
#include <cstddef>
#include <limits>
#include <memory>
#include <string>

namespace {

/** Threads add to one number, and none waits for another. */
void
race()
{
  int sum = 0;
#pragma omp parallel for num_threads(3)
  for (int i = 0; i < 3000; ++i)
    sum += i; // the fault
  volatile int kept = sum;
  static_cast<void>(kept);
}

/** Reads behind the end of memory on the heap. */
void
buffer(std::size_t size)
{
  const std::unique_ptr<int[]> numbers(new int[size]());
  volatile int kept = numbers[size]; // the fault
  static_cast<void>(kept);
}

/** Forgets memory. */
void
leak(std::size_t size)
{
  int* volatile numbers = new int[size]();
  // cppcheck-suppress memleak ; the fault
  numbers = nullptr;
  static_cast<void>(numbers);
}

/** Exceeds the range of int. */
void
overflow(int one)
{
  volatile int kept = std::numeric_limits<int>::max() + one; // the fault
  static_cast<void>(kept);
}

} // namespace

int
main(int argc, char** argv)
{
  const std::string fault = argc == 2 ? argv[1] : "";
  if (fault == "race")
    race();
  else if (fault == "buffer")
    buffer(static_cast<std::size_t>(argc));
  else if (fault == "leak")
    leak(static_cast<std::size_t>(argc));
  else if (fault == "overflow")
    overflow(argc);
  else
    return 2;
  return 0;
}
