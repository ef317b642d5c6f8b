#include "summary/summary_modes.h"

#include "summary/plain_text.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

std::vector<Mode>
summarizeModes(const ChainSet& chain_set)
{
  std::vector<Mode> modes;
  double sum = 0.0;
  for (const auto& chains : chain_set.modes) {
    std::vector<Chain> members;
    for (const int i : chains.members)
      members.push_back(chain_set.chains[static_cast<std::size_t>(i)]);
    const PoseMatrix draws = pooledDraws(members);
    if (draws.rows() == 0)
      continue;
    Mode mode;
    mode.chains = chains.members;
    mode.mean = meanPose(draws);
    mode.covariance =
        covarianceAbout(mode.mean, draws, CovarianceConvention::Parameters);
    mode.weight = std::exp(chains.log_evidence - chain_set.modes.front().log_evidence);
    sum += mode.weight;
    modes.push_back(mode);
  }
  for (auto& mode : modes)
    mode.weight /= sum;
  std::stable_sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) {
    return a.weight > b.weight;
  });
  return modes;
}

std::string
modesMessage(const Summary& summary)
{
  std::string text =
      "the chains found " + std::to_string(summary.modes.size()) + " modes, of weight";
  for (const auto& mode : summary.modes)
    text += formatted(" %.3f", mode.weight);
  return text + "; mean and covariance mix them";
}

std::string
movedMessage(const ChainSet& chain_set)
{
  if (chain_set.num_moved_chains == 0)
    return "";
  return formatted("; %d of %d chains had ended in a mode at least %.0f nats worse and "
                   "were moved to the best one",
                   chain_set.num_moved_chains,
                   static_cast<int>(chain_set.chains.size()),
                   chain_set.moved_by_nats);
}

} // namespace bayesian_icp
