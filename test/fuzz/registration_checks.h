/** \file
 * \brief What holds of a registration's result, whatever its input was. Each function
 * ends the fuzzer if it does not.
 */
#pragma once

#include "registration_input.h"

#include <bayesian_icp/stochastic_gradient_icp.h>
#include <bayesian_icp/summary.h>

namespace bayesian_icp::fuzz {

void
checkEstimate(const Summary& summary, const PoseMatrix& samples);

void
checkDescent(const RegistrationInput& input, const StochasticGradientIcpResult& result);

} // namespace bayesian_icp::fuzz
