/** \file
 * \brief Clouds and options at the edge of what can be registered, and what is to come
 * of each.
 */
#pragma once

#include "torture_clouds.h"

#include <bayesian_icp/options.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp {
namespace test {

/** What a registration has to end in. */
enum class Verdict {
  /** Status Ok, and the truth lies within the posterior. */
  Right,
  /** Draws, but a status that is not Ok and a message that says why. */
  Warned,
  /** As Warned, and yet the truth lies within the posterior. */
  RightButWarned,
  /** No draws: a status and a message that says why. */
  Refused
};

struct Expectation {
  Verdict verdict;
  /** A piece of the message. */
  std::string reason;
};

struct TortureCase {
  /** For the name of the test. */
  std::string id;
  /** For the table. */
  std::string description;
  std::function<TorturePair()> make;
  std::function<void(Options&)> change;
  /** Of presets calibrated, exact and paper. */
  std::array<Expectation, 3> expected;
};

/** \brief The presets in the order of TortureCase::expected. */
constexpr std::array<Preset, 3> torture_presets = {
    Preset::Calibrated, Preset::Exact, Preset::Paper};

/** \brief Options before TortureCase::change: quick, and with a scale that fits the
 * clouds of most cases. */
Options
tortureOptions(Preset preset);

/** \brief The cases of odd clouds. */
std::vector<TortureCase>
tortureCasesOfClouds();

/** \brief All cases, in the order of the table. */
std::vector<TortureCase>
tortureCases();

} // namespace test
} // namespace bayesian_icp
