/** \file
 * \brief Another program as a function: text in, text out, and no file in between.
 */
#pragma once

#include <string>
#include <vector>

namespace bayesian_icp::plot {

/** \brief What a program did. */
struct ProgramResult {
  /** Whether it was found and ended with exit code 0. */
  bool is_good = false;
  /** Its standard output and its standard error; if it could not be started, the
   * reason. */
  std::string output;
  std::string errors;
};

/** \brief Run a program to its end. The texts are kept in memory, not in files: it
 * needs no folder for temporary ones.
 * \param[in] words its name, which is looked for as the shell does, and its arguments
 * \param[in] input its standard input */
ProgramResult
runChildProgram(const std::vector<std::string>& words, const std::string& input);

} // namespace bayesian_icp::plot
