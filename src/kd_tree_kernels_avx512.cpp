// The search for processors with AVX-512: a leaf in one vector. Compiled with more
// instructions than the library: include nothing here but the search and the
// intrinsics.
#include "kd_tree_eight_floats.h"
#include "kd_tree_search.h"

namespace bayesian_icp {
namespace kd_tree {
namespace {

struct SixteenFloats {
  using Vector = __m512;
  static constexpr std::size_t width = 16;

  // clang-format off
  static Vector load(const float* from) { return _mm512_load_ps(from); }
  static Vector fill(float a) { return _mm512_set1_ps(a); }
  static Vector add(Vector a, Vector b) { return _mm512_add_ps(a, b); }
  static Vector sub(Vector a, Vector b) { return _mm512_sub_ps(a, b); }
  static Vector mul(Vector a, Vector b) { return _mm512_mul_ps(a, b); }
  static Vector min(Vector a, Vector b) { return _mm512_min_ps(a, b); }
  static float smallest(Vector a) { return _mm512_reduce_min_ps(a); }
  static unsigned lessEqual(Vector a, Vector b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
  static unsigned equal(Vector a, Vector b) { return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ); }
  // clang-format on
};

} // namespace

void
searchAvx512(const View& tree, const float* query, std::uint32_t hint, Best& best)
{
  search<EightFloats, SixteenFloats>(tree, query, hint, best);
}

} // namespace kd_tree
} // namespace bayesian_icp
