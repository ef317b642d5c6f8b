// The searches for processors with AVX2. Compiled with more instructions than the
// library: include nothing here but the searches and the intrinsics.
#include "search/kd_tree_search.h"

#include <immintrin.h>

namespace bayesian_icp::kd_tree {
namespace {

struct EightFloats {
  using Vector = __m256;
  static constexpr std::size_t width = 8;

  // clang-format off
  static Vector load(const float* from) { return _mm256_load_ps(from); }
  static void store(float* to, Vector a) { _mm256_store_ps(to, a); }
  static Vector fill(float a) { return _mm256_set1_ps(a); }
  static Vector min(Vector a, Vector b) { return _mm256_min_ps(a, b); }
  static Vector max(Vector a, Vector b) { return _mm256_max_ps(a, b); }
  static unsigned lessEqual(Vector a, Vector b) { return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ))); }
  static unsigned equal(Vector a, Vector b) { return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_EQ_OQ))); }
  // clang-format on

  static float
  smallest(Vector a)
  {
    __m128 b = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_min_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_min_ps(b, _mm_shuffle_ps(b, b, 1)));
  }
};

} // namespace

const Searches avx2_searches = searchesWith<EightFloats>();

} // namespace bayesian_icp::kd_tree
