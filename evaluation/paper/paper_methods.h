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
  /** Gaussians of the methods that are no samplers, by the method's name. */
  mutable std::map<std::string, TwistGaussian> gaussians;
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
const std::vector<PaperMethod>&
paperMethods();

/** \brief The method of this name, which is there. */
const PaperMethod&
paperMethod(const std::string& name);

} // namespace bayesian_icp::evaluate
