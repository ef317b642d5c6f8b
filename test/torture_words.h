/** \file
 * \brief Words for the tables of torture cases.
 */
#pragma once

#include "torture_cases.h"

namespace bayesian_icp {
namespace test {

/** A pair that \p change has spoilt. */
inline std::function<TorturePair()>
spoilt(const std::function<void(TorturePair&)>& change)
{
  return [change] {
    TorturePair pair = usualPair();
    change(pair);
    return pair;
  };
}

inline void
unchanged(Options&)
{}

static const Expectation right = {Verdict::Right, ""};

inline Expectation
warned(const char* reason)
{
  return {Verdict::Warned, reason};
}

inline Expectation
rightButWarned(const char* reason)
{
  return {Verdict::RightButWarned, reason};
}

inline Expectation
refused(const char* reason)
{
  return {Verdict::Refused, reason};
}

/** Preset paper's chains at its own step size and budget. */
static const Expectation as_ever = warned("");

} // namespace test
} // namespace bayesian_icp
