/** \file
 * \brief The ways to a pose whose accuracy is compared.
 */
#pragma once

#include "paper/paper_methods.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Starts are uniform within these of zero, on each axis [m, rad]: the paper's.
 */
constexpr double accuracy_translation_range = 1.0;
constexpr double accuracy_rotation_range = 0.3;

/** \brief A pose and what its method says of it. */
struct AccuracyEstimate {
  /** T_target_source [m, rad]; NaN if there is none. */
  Vector6d pose;
  /** Short name of the method's own. */
  std::string status;
};

struct AccuracyMethod {
  /** In the file. */
  std::string name;
  std::function<AccuracyEstimate(const PaperProblem&, const DrawPlan&)> run;
};

/** \brief What they are:
 *
 * - `paper`, `exact`, `calibrated`: means of 2000 draws. The paper's prior is about
 *   zero and its chains begin at the start, with 500 steps of burn-in; the others take
 *   the start as initial guess, and their prior is about it, with the variance that
 *   starts have;
 * - `sgd-icp`: with Adam and the defaults of the authors' program, but a target point
 *   may be in several pairs, as in the paper's Bayesian ICP;
 * - `sgd-icp-filter`: the same with the program's filter of repeated matches. From a
 *   start far off nearly all points have the same few neighbours, of which it then
 *   leaves too few to go on;
 * - `icp`: standard ICP to completion. */
const std::vector<AccuracyMethod>&
accuracyMethods();

} // namespace bayesian_icp::evaluate
