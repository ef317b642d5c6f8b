/** \file
 * \brief What decides the result of pcl_bayesian_icp --method sgd-icp.
 */
#pragma once

#include <bayesian_icp/stochastic_gradient_icp.h>

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/variables_map.hpp>

#include <Eigen/Core>

#include <nlohmann/json_fwd.hpp>

#include <limits>
#include <string>

namespace bayesian_icp::app {

/** \brief Options of SGD-ICP and where it starts. */
struct SgdSettings {
  /** T_target_source at which the descent starts. */
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  /** Largest distance of corresponding points [m]. */
  double max_distance = std::numeric_limits<double>::infinity();
  StochasticGradientIcpOptions options;
};

/** \brief The options that only SGD-ICP has, with their descriptions. */
boost::program_options::options_description
describeSgdOptions();

/** \brief What a command line says of SGD-ICP, the step size found.
 * \throws io::UsageError if it is not understood or has options of the posterior,
 *         io::FileError if the file of a guess cannot be read */
SgdSettings
sgdSettingsFrom(const boost::program_options::variables_map& given);

/** \brief All settings, units in the names of keys. */
nlohmann::ordered_json
jsonOf(const SgdSettings& settings);

/** \brief What --help says about the method, the defaults of shared options included.
 */
std::string
aboutSgdIcp();

} // namespace bayesian_icp::app
