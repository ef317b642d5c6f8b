/** \file
 * \brief Words for the tables of torture cases.
 */
#pragma once

#include "class/torture_cases.h"

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

static const Expectation right = {Verdict::Right, {{Status::Ok, "the chains mixed"}}};

inline Expectation
warned(Status status, const char* reason)
{
  return {Verdict::Warned, {{status, reason}}};
}

inline Expectation
rightButWarned(Status status, const char* reason)
{
  return {Verdict::RightButWarned, {{status, reason}}};
}

inline Expectation
refused(Status status, const char* reason)
{
  return {Verdict::Refused, {{status, reason}}};
}

static const Expectation no_such_option = {Verdict::NoSuchOption, {}};

static const Expectation not_mixed = warned(Status::NotMixed, "did not mix");

static const Expectation diverged = warned(Status::Diverged, "chains diverged");

/** Preset paper's chains are chaotic at its own step size: which of the two it is can
 * depend on the processor's last bits. */
static const Expectation not_mixed_or_diverged = {
    Verdict::Warned,
    {{Status::NotMixed, "did not mix"}, {Status::Diverged, "chains diverged"}}};

} // namespace test
} // namespace bayesian_icp
