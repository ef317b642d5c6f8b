/** \file
 * \brief What a posterior amounts to, in one sentence.
 */
#pragma once

#include "html/page.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/summary.h>

#include <string>

namespace bayesian_icp::app {

/** \brief The first thing that a reader ought to know. */
struct Verdict {
  html::Tone tone = html::Tone::Bad;
  /** Whether to rely on it, in a few words: "Do not trust the ±". */
  std::string heading;
  /** Why not, if so; the pose with ± one standard deviation for every axis, of each
   * mode if there are several; the motions that the clouds do not hold; flags. */
  std::string sentence = {};
  /** What the ± mean with this preset; empty if that needs no words. */
  std::string scale_note = {};
};

/** \brief The verdict on a run's posterior. */
Verdict
verdictOf(const Summary& summary, Preset preset);

/** \brief "x 0.0213 m ± 0.42 mm": mean with as many digits as the standard deviation
 * justifies; all spaces are U+00A0, no-break spaces.
 * \param[in] coordinate index in (x, y, z, roll, pitch, yaw)
 * \param[in] mean,standard_deviation [m, rad]; angles are told in degrees */
std::string
uncertainText(int coordinate, double mean, double standard_deviation);

} // namespace bayesian_icp::app
