/** \file
 * \brief The command line of pcl_bayesian_icp --method sgd-icp, which has options of
 * its own.
 */
#pragma once

#include <bayesian_icp/stochastic_gradient_icp.h>

#include <boost/program_options/options_description.hpp>

#include <Eigen/Core>

#include <limits>
#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks of SGD-ICP. */
struct SgdRequest {
  std::string source_file;
  std::string target_file;
  /** Empty if no files are wanted. */
  std::string output_folder;
  bool is_json = false;
  bool is_quiet = false;
  /** T_target_source at which the descent starts. */
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  /** Largest distance of corresponding points [m]. */
  double max_distance = std::numeric_limits<double>::infinity();
  StochasticGradientIcpOptions options;
};

/** \brief Whether the command line has --method sgd-icp, and neither --help nor
 * --version.
 * \throws io::UsageError if the method is unknown, or if it is bayesian-icp and there
 *         are options that only SGD-ICP has */
bool
isSgdIcpAskedFor(int argc, const char* const* argv);

/** \brief Read a command line that has --method sgd-icp.
 * \throws io::UsageError if it cannot be understood or has options of the posterior,
 *         io::FileError if the file of a guess cannot be read */
SgdRequest
parseSgdCommandLine(int argc, const char* const* argv);

/** \brief The options that only SGD-ICP has, with their descriptions. */
boost::program_options::options_description
describeSgdOptions();

/** \brief What --help says about the method, the defaults of shared options included.
 */
std::string
aboutSgdIcp();

} // namespace bayesian_icp::app
