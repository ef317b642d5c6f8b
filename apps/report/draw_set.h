/** \file
 * \brief Draws in the form in which charts show them: differences from the mean pose,
 * coordinate by coordinate, in readable units, few enough to be drawn.
 */
#pragma once

#include "register/run.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief One coordinate of the pose in the charts. */
struct Axis {
  std::string name;
  /** "mm", "m" or "°". */
  std::string unit;
  /** From metres or radians to the unit. */
  double factor = 1.0;
  /** Of the difference from the mean, in the unit; NaN where undefined. */
  double standard_deviation = 0.0;
  double quantile_2_5 = 0.0;
  double quantile_97_5 = 0.0;
};

/** \brief What charts of the differences from the mean pose show, with its unit. */
std::string
differenceLabel(const Axis& axis);

/** \brief Draws of one chain. */
struct ChainDraws {
  /** Index among all chains, the diverged ones included. */
  int chain = 0;
  /** A draw a row: differences from the mean pose, coordinate by coordinate, in the
   * units of the axes, angles wrapped about it. */
  Eigen::MatrixXd errors;
};

/** \brief Chains that have not diverged and have draws. */
struct DrawSet {
  std::array<Axis, 6> axes;
  std::vector<ChainDraws> chains;
};

/** \brief The draws of a run with at least one draw. */
DrawSet
drawSetOf(const RegistrationResult& result);

/** \brief One coordinate of all draws, chain after chain. */
Eigen::VectorXd
pooledErrors(const DrawSet& draws, int coordinate);

/** \brief Ranks of one coordinate's draws among those of all chains, 0 for the
 * smallest, ties in the middle of theirs: a vector for each chain. */
std::vector<Eigen::VectorXd>
ranksOf(const DrawSet& draws, int coordinate);

/** \brief Width of a kernel that shows the density of one coordinate: Silverman's for
 * the spread within chains, so that chains in different places stay apart. If no chain
 * moves, as with one draw in each, it is that for the spread of all draws. */
double
kernelWidth(const DrawSet& draws, int coordinate);

} // namespace bayesian_icp::app
