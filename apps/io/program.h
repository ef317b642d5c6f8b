/** \file
 * \brief What all programs do alike: print, and end where they cannot do what was
 * asked.
 */
#pragma once

#include "io/errors.h"

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

/** \brief Say on standard error why the program ends. To be called in a
 * `catch (...)`.
 * \return the exit code: 2 usage, 3 a file, 1 anything else */
inline int
explainFailure()
{
  try {
    throw;
  }
  catch (const UsageError& error) {
    tell(std::string(error.what()) + " (see --help)");
    return 2;
  }
  catch (const FileError& error) {
    tell(error.what());
    return 3;
  }
  catch (const std::bad_alloc&) {
    tell("out of memory");
    return 1;
  }
  catch (const std::exception& error) {
    tell(std::string("failed: ") + error.what());
    return 1;
  }
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
  try {
    return work();
  }
  catch (...) {
    const int exit_code = explainFailure();
    on_failure(exit_code);
    return exit_code;
  }
}

} // namespace bayesian_icp::io
