/** \file
 * \brief The command line of pcl_bayesian_icp_transform.
 */
#pragma once

#include <optional>
#include <string>

namespace bayesian_icp::transform {

/** \brief Which of the poses of a posterior.json. */
enum class PoseChoice { Final, Mean };

/** \brief What the user asks for. */
struct Request {
  std::string input_file;
  std::string output_file;
  /** Six numbers, or the name of a matrix file or of a posterior.json. */
  std::string pose;
  PoseChoice choice = PoseChoice::Final;
  bool is_inverse = false;
  bool may_overwrite_input = false;
};

/** \brief Read the command line.
 * \return nothing if it asks for help or version, which has been printed
 * \throws io::UsageError if it cannot be understood */
std::optional<Request>
parseCommandLine(int argc, const char* const* argv);

} // namespace bayesian_icp::transform
