// The searches for any x86-64 processor.
#include "search/kd_tree_search.h"

#include <immintrin.h>

namespace bayesian_icp::kd_tree {
namespace {

struct FourFloats {
  using Vector = __m128;
  static constexpr std::size_t width = 4;

  // clang-format off
  static Vector load(const float* from) { return _mm_load_ps(from); }
  static void store(float* to, Vector a) { _mm_store_ps(to, a); }
  static Vector fill(float a) { return _mm_set1_ps(a); }
  static Vector min(Vector a, Vector b) { return _mm_min_ps(a, b); }
  static Vector max(Vector a, Vector b) { return _mm_max_ps(a, b); }
  static unsigned lessEqual(Vector a, Vector b) { return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a, b))); }
  static unsigned equal(Vector a, Vector b) { return static_cast<unsigned>(_mm_movemask_ps(_mm_cmpeq_ps(a, b))); }
  // clang-format on

  static float
  smallest(Vector a)
  {
    a = min(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(min(a, _mm_shuffle_ps(a, a, 1)));
  }
};

} // namespace

const Searches sse2_searches = searchesWith<FourFloats>();

} // namespace bayesian_icp::kd_tree
