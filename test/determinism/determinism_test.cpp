// The same numbers to the last bit for any number of threads, any instruction set, and
// run after run; and that rounding is not amplified in the runs whose numbers are kept.
#include "determinism_runs.h"

#include <bayesian_icp/kd_tree.h>

#include <gtest/gtest.h>

#include <iostream>
#include <stdexcept>

namespace bayesian_icp {
namespace {

/** What the library is told that the processor can do. */
InstructionSet best_instruction_set = InstructionSet::Avx2;

} // namespace

// Takes the place of the library's own function, which says what the processor can do:
// what a program defines goes before what an archive does. So all of the library,
// wherever it builds a tree, searches by the instructions of this test.
std::vector<InstructionSet>
supportedInstructionSets()
{
  std::vector<InstructionSet> supported{InstructionSet::Plain};
#if defined(__x86_64__)
  if (best_instruction_set >= InstructionSet::Sse2)
    supported.push_back(InstructionSet::Sse2);
  if (best_instruction_set >= InstructionSet::Avx2 && __builtin_cpu_supports("avx2"))
    supported.push_back(InstructionSet::Avx2);
#endif
  return supported;
}

namespace test {
namespace {

class Determinism : public ::testing::TestWithParam<std::string> {
protected:
  void
  TearDown() override
  {
    best_instruction_set = InstructionSet::Avx2;
  }
};

TEST_P(Determinism, NumberOfThreadsChangesNoBit)
{
  const RunRecord reference = makeRun(GetParam());
  for (const int num_threads : {1, 2, 3, 8}) {
    const RunRecord record = makeRun(GetParam(), {num_threads, false});
    EXPECT_TRUE(areIdentical(reference, record))
        << num_threads << " threads: " << difference(reference, record) << " units";
  }
}

TEST_P(Determinism, InstructionSetChangesNoBit)
{
  const RunRecord reference = makeRun(GetParam(), {2, false});
  for (const InstructionSet set : {InstructionSet::Plain, InstructionSet::Sse2}) {
    best_instruction_set = set;
    // The library refuses what it believes the processor has not.
    ASSERT_THROW(KdTree(Eigen::Matrix3Xf::Zero(3, 1), 1, InstructionSet::Avx2),
                 std::invalid_argument)
        << "the library does not ask this program for the instruction set";
    const RunRecord record = makeRun(GetParam(), {2, false});
    EXPECT_TRUE(areIdentical(reference, record))
        << "instruction set " << static_cast<int>(set) << ": "
        << difference(reference, record) << " units";
  }
}

TEST_P(Determinism, RoundingIsNotAmplified)
{
  // What has to hold for a stored run to be the same on another processor.
  const double change = difference(makeRun(GetParam()), makeRun(GetParam(), {1, true}));
  EXPECT_LT(change, rounding_tolerance);
  std::cout << "the last bit of all coordinates changes it by " << change << " units\n";
}

INSTANTIATE_TEST_SUITE_P(OfEachMethod,
                         Determinism,
                         ::testing::ValuesIn(runNames()),
                         [](const auto& run) { return run.param; });

} // namespace
} // namespace test
} // namespace bayesian_icp
