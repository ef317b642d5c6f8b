/** \file
 * \brief Clouds, guess and options for the registration, out of the bytes of an input.
 */
#pragma once

#include <bayesian_icp/options.h>
#include <bayesian_icp/pose.h>

#include <cstdint>
#include <string_view>

namespace bayesian_icp::fuzz {

/** \brief Something to register: as odd as the bytes say, but of bounded cost. */
struct RegistrationInput {
  /** Points [m], any coordinates, also none; at most 80 each for preset `calibrated`,
   * 40 for the others. */
  Eigen::Matrix3Xf source;
  Eigen::Matrix3Xf target;
  Vector6d guess = Vector6d::Zero();
  /** Any options, but few draws and chains. */
  Options options;
  /** ICP's maximum correspondence distance [m]. */
  double gate = 1.0;
  int icp_iterations = 5;
  bool is_reciprocal = false;
  bool use_mean = false;
  /** Steps after which the run is cancelled by its progress callback. */
  int max_num_steps = 0;
};

RegistrationInput
registrationInputOf(const std::uint8_t* data, std::size_t size);

} // namespace bayesian_icp::fuzz
