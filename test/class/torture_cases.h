/** \file
 * \brief Clouds and options at the edge of what can be registered, and what is to come
 * of each.
 */
#pragma once

#include <bayesian_icp/options.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/summary.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::test {

/** Two clouds [m] and the pose between them. */
struct TorturePair {
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  Vector6d guess = Vector6d::Zero();
  Vector6d truth = Vector6d::Zero();
  /** Whether there is a pose that is right: not where the clouds do not belong
   * together. */
  bool has_truth = true;
  /** Noise of a usual scan of this size [m]. */
  double noise = 0.003;
  /** Along so many of the source's first axes nothing holds it. */
  int num_free_axes = 0;
};

/** What a registration has to end in. */
enum class Verdict {
  /** Status Ok, and the posterior is right: isRight() in torture_test.cpp. */
  Right,
  /** Draws, but a status that is not Ok and a message that says why. */
  Warned,
  /** As Warned, and yet the posterior is right. */
  RightButWarned,
  /** No draws: a status and a message that says why. */
  Refused,
  /** The preset does not have the option that the case changes. */
  NoSuchOption,
  /** The case is not tried. */
  NotTried
};

/** A status and a piece of its message. */
struct Outcome {
  Status status;
  std::string reason;
};

struct Expectation {
  Verdict verdict;
  /** Any of these will do. */
  std::vector<Outcome> outcomes;
};

struct TortureCase {
  /** For the name of the test. */
  std::string id;
  /** For the table. */
  std::string description;
  /** Makes the clouds, and may change the options. */
  std::function<TorturePair(Options&)> make;
  /** Of presets calibrated, exact and paper. */
  std::array<Expectation, 3> expected;
  /** Of preset paper with small steps. */
  Expectation with_small_steps = {Verdict::NotTried, {}};
};

/** \brief Options before TortureCase::make: quick, and with a scale that fits the
 * clouds of most cases. Preset paper has the paper's scale and step size. */
Options
tortureOptions(Preset preset);

/** \brief Those of preset paper with a scale and a step size with which its chains mix
 * on usualPair(). */
Options
smallStepOptions();

/** \brief All cases, in the order of the table. */
std::vector<TortureCase>
tortureCases();

} // namespace bayesian_icp::test
