/** \file
 * \brief How a program ends that cannot do what it was asked.
 */
#pragma once

#include "io/errors.h"

#include <iostream>
#include <string>

namespace bayesian_icp::io {

/** \brief Say on standard error why \p program ends. To be called in a `catch (...)`.
 * \return the exit code: 2 usage, 3 a file, 1 anything else */
inline int
explainFailure(const std::string& program)
{
  const auto tell = [&program](const std::string& reason) {
    std::cerr << program << ": " << reason << '\n';
  };
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
  catch (const std::exception& error) {
    tell(std::string("failed: ") + error.what());
    return 1;
  }
}

} // namespace bayesian_icp::io
