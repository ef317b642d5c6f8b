/** \file
 * \brief The command line of pcl_bayesian_icp_transform.
 */
#pragma once

#include <string>

namespace bayesian_icp::transform {

/** \brief Which of the poses of a posterior.json. */
enum class PoseChoice { Final, Mean };

/** \brief What the user asks for. */
struct Request {
  enum class Kind { Transform, ShowHelp, ShowVersion };
  Kind kind = Kind::Transform;
  std::string input_file;
  std::string output_file;
  /** Six numbers, or the name of a matrix file or of a posterior.json. */
  std::string pose;
  PoseChoice choice = PoseChoice::Final;
  bool is_inverse = false;
  bool may_overwrite_input = false;
};

/** \brief Read the command line.
 * \throws io::UsageError if it cannot be understood */
Request
parseCommandLine(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
helpText();

} // namespace bayesian_icp::transform
