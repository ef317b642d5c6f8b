#include "graph/loop_candidates.h"

namespace bayesian_icp::app {

std::vector<std::pair<int, int>>
loopCandidates(const std::vector<GaussianPose>& poses, double radius)
{
  std::vector<std::pair<int, int>> loops;
  for (std::size_t later = 0; later < poses.size(); ++later) {
    bool was_away = false;
    double least = radius;
    std::size_t nearest = later;
    for (std::size_t k = later; k-- > 0;) {
      const double distance =
          (poses[k].mean.head<3>() - poses[later].mean.head<3>()).norm();
      was_away = was_away || distance > 2.0 * radius;
      if (!was_away || distance > least)
        continue;
      least = distance;
      nearest = k;
    }
    if (nearest != later)
      loops.emplace_back(static_cast<int>(nearest), static_cast<int>(later));
  }
  return loops;
}

} // namespace bayesian_icp::app
