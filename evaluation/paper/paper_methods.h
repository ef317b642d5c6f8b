/** \file
 * \brief The methods that the paper's experiments compare, and those beyond.
 */
#pragma once

#include "methods/published_covariances.h"
#include "samplers/sampler_runs.h"
#include "study/scan_pairs.h"

#include <bayesian_icp/kd_tree.h>

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A pair and what is made of it once. Not for several threads at a time. */
struct PaperProblem {
  explicit PaperProblem(const ScanPair& scan_pair)
  : pair(scan_pair)
  , tree(scan_pair.target.cast<float>())
  {}

  /** Must outlive this object. */
  const ScanPair& pair;
  KdTree tree;
  /** Gaussians of the methods that are no samplers, by the method's name, and the CPU
   * time that they took [s]. */
  mutable std::map<std::string, std::pair<TwistGaussian, double>> gaussians;
};

/** \brief What is drawn, and from where. */
struct DrawPlan {
  /** Over all chains, of which there are four. */
  int num_draws = 2000;
  std::uint64_t seed = 1;
  int num_threads = 1;
  /** The guess [m, rad]. */
  Vector6d start = Vector6d::Zero();
  /** Standard deviations of the starts of preset `paper` about the guess, six equal
   * numbers [m, rad]. */
  double initial_spread = 0.0;
};

/** \brief A way to draws. The status of a Gaussian, which is drawn from as one chain,
 * is "gaussian", or "no_covariance" without draws. */
struct PaperMethod {
  /** In files. */
  std::string name;
  std::function<SamplerRun(const PaperProblem&, const DrawPlan&)> run;
};

/** \brief All of them start at the identity, and have the paper's prior where they have
 * one at all: mean zero, variance 0.125 m^2 and rad^2 about the origin.
 *
 * - `bayesian-icp`: the paper's Algorithm 1 with its constants (preset `paper`);
 * - `bayesian-icp-1e-5`: the same with a tenth of its step size;
 * - `exact`: preset `exact` for the likelihood that the paper states, N = 6000 and
 *   sigma = 1 m;
 * - `calibrated`: preset `calibrated`;
 * - `online-icp`, `online-icp-point`: Censi's covariance for point-to-plane, as Prakhya
 *   et al. and the paper have it, and for point-to-point ICP, about ICP's result, with
 *   the same sigma = 1 m; without a prior;
 * - `online-icp-noise`: point-to-plane with the noise that the residuals have;
 * - `hessian`: residual variance times the inverse of point-to-point ICP's Hessian;
 * - `gicp`: the inverse of the Hessian of PCL's GICP, about its result. */
std::vector<PaperMethod>
paperMethods();

/** \brief The method of this name, which is there. */
PaperMethod
paperMethod(const std::string& name);

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

/** \brief A way to a pose whose accuracy is compared. */
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
std::vector<AccuracyMethod>
accuracyMethods();

} // namespace bayesian_icp::evaluate
