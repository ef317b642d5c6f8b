// In a file of its own, so that a test can define the function in its place.
#include <bayesian_icp/kd_tree.h>

namespace bayesian_icp {

std::vector<InstructionSet>
supportedInstructionSets()
{
  std::vector<InstructionSet> supported{InstructionSet::Plain};
#if defined(BAYESIAN_ICP_X86_KERNELS)
  supported.push_back(InstructionSet::Sse2);
  if (__builtin_cpu_supports("avx2"))
    supported.push_back(InstructionSet::Avx2);
#endif
  return supported;
}

} // namespace bayesian_icp
