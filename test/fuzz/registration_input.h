/** \file
 * \brief Clouds, guess and options for the registration, out of the bytes of an input.
 */
#pragma once

#include "paper/monte_carlo_icp.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/stochastic_gradient_icp.h>

#include <cstdint>

namespace bayesian_icp::fuzz {

/** \brief What registers an input. */
enum class Method {
  /** The posterior: by the library without PCL, and by the class. */
  Posterior,
  /** The posterior by the class for points with normals and Scalar double. */
  PosteriorOfNormals,
  StochasticGradient,
  MonteCarlo
};

/** \brief Something to register: as odd as the bytes say, but of bounded cost. */
struct RegistrationInput {
  Method method = Method::Posterior;
  /** Points [m], any coordinates, also none; at most 80 each for preset `calibrated`,
   * 40 for the others. */
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  Vector6d guess = Vector6d::Zero();
  /** Any options, but at most 100 000 draws. */
  Options options;
  StochasticGradientIcpOptions descent;
  /** At most 20 runs and as many iterations of each. */
  evaluate::MonteCarloIcpOptions monte_carlo;
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
