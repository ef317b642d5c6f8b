/** \file
 * \brief What all programs do alike: print, and end where they cannot do what was
 * asked.
 */
#pragma once

#include "io/errors.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <iostream>
#include <new>
#include <string>

namespace bayesian_icp::io {

/** \brief Print on standard output.
 * \throws FileError if it cannot be written, for example because the disk is full */
inline void
print(const std::string& text)
{
  std::cout << text << std::flush;
  if (!std::cout)
    throw FileError("standard output", "cannot be written");
}

/** \brief Exit codes of all programs. */
enum ExitCode {
  Good = 0,
  /** There is a result, which is not to be relied on; or an unusual failure. */
  NotGood = 1,
  BadUsage = 2,
  /** A file cannot be read, used or written. */
  BadFile = 3,
  /** SIGINT or SIGTERM, see interrupt.h. */
  Interrupted = 130
};

/** \brief The running program as its messages name it: what runProgram() was told. */
inline std::string program_name;

/** \brief Say something on standard error, after the program's name; nothing if
 * \p message is empty. */
inline void
tell(const std::string& message)
{
  if (!message.empty())
    std::cerr << program_name + ": " + message + '\n';
}

/** \brief What `main` does: run \p work. A file that would grow beyond the limit on the
 * size of files (`ulimit -f`) is an error as on a full disk, not a signal that kills.
 * \param[in] on_failure told the exit code of a failure that has been explained
 * \return exit code of \p work, or that of its failure, which is explained */
template <typename Work>
int
runProgram(
    const std::string& program,
    const Work& work,
    const std::function<void(int exit_code)>& on_failure = [](int) {})
{
  program_name = program;
  std::signal(SIGXFSZ, SIG_IGN);
  // So that no output file takes the place of a closed standard error.
  for (int descriptor = 0; (descriptor = open("/dev/null", O_RDONLY)) >= 0;)
    if (descriptor > STDERR_FILENO) {
      close(descriptor);
      break;
    }
  int exit_code = NotGood;
  try {
    return work();
  }
  catch (const Answered&) {
    return Good;
  }
  catch (const UsageError& error) {
    tell(std::string(error.what()) + " (see --help)");
    exit_code = BadUsage;
  }
  catch (const FileError& error) {
    tell(error.what());
    exit_code = BadFile;
  }
  catch (const std::bad_alloc&) {
    tell("out of memory");
  }
  catch (const std::exception& error) {
    tell(std::string("failed: ") + error.what());
  }
  on_failure(exit_code);
  return exit_code;
}

} // namespace bayesian_icp::io
