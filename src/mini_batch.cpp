#include <bayesian_icp/mini_batch.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace bayesian_icp {

const char*
toString(MiniBatchSampling sampling)
{
  return sampling == MiniBatchSampling::WithReplacement ? "with-replacement"
                                                        : "shuffled-epochs";
}

MiniBatches::MiniBatches(std::size_t num_points,
                         std::size_t batch_size,
                         MiniBatchSampling sampling)
: sampling_(sampling)
, shuffled_(num_points)
, num_dealt_(num_points)
, batch_(std::min(batch_size, num_points))
{
  std::iota(shuffled_.begin(), shuffled_.end(), std::size_t(0));
}

const std::vector<std::size_t>&
MiniBatches::next(Random& random)
{
  if (sampling_ == MiniBatchSampling::WithReplacement)
    for (auto& index : batch_)
      index = random.index(shuffled_.size());
  else
    dealFromShuffledSource(random);
  return batch_;
}

void
MiniBatches::dealFromShuffledSource(Random& random)
{
  if (shuffled_.size() - num_dealt_ < batch_.size())
    num_dealt_ = 0;
  // Fisher-Yates, as far as the batch needs it: what lies before num_dealt_ has been
  // used in this epoch.
  for (auto& index : batch_) {
    const std::size_t pick = num_dealt_ + random.index(shuffled_.size() - num_dealt_);
    std::swap(shuffled_[num_dealt_], shuffled_[pick]);
    index = shuffled_[num_dealt_++];
  }
}

} // namespace bayesian_icp
