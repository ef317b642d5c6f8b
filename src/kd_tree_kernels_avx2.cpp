// The search for processors with AVX2. Compiled with more instructions than the
// library: include nothing here but the search and the intrinsics.
#include "kd_tree_eight_floats.h"
#include "kd_tree_search.h"

namespace bayesian_icp {
namespace kd_tree {

void
searchAvx2(const View& tree, const float* query, std::uint32_t hint, Best& best)
{
  search<EightFloats, EightFloats>(tree, query, hint, best);
}

} // namespace kd_tree
} // namespace bayesian_icp
