// The searches for any processor.
#include "search/kd_tree_search.h"

namespace bayesian_icp::kd_tree {
namespace {

struct OneFloat {
  using Vector = float;
  static constexpr std::size_t width = 1;

  // clang-format off
  static Vector load(const float* from) { return *from; }
  static void store(float* to, Vector a) { *to = a; }
  static Vector fill(float a) { return a; }
  static Vector min(Vector a, Vector b) { return b < a ? b : a; }
  static Vector max(Vector a, Vector b) { return a < b ? b : a; }
  static float smallest(Vector a) { return a; }
  static unsigned lessEqual(Vector a, Vector b) { return a <= b; }
  static unsigned equal(Vector a, Vector b) { return a == b; }
  // clang-format on
};

} // namespace

const Searches plain_searches = searchesWith<OneFloat>();

} // namespace bayesian_icp::kd_tree
