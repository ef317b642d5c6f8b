#include "sampler/mini_batch.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace bayesian_icp {

MiniBatches::MiniBatches(std::size_t num_points,
                         std::size_t batch_size,
                         MiniBatchSampling sampling)
: sampling_(sampling)
, shuffled_(num_points)
, batch_(std::min(batch_size, num_points))
{
  std::iota(shuffled_.begin(), shuffled_.end(), std::size_t(0));
}

MiniBatches::MiniBatches(std::vector<std::size_t> points) : shuffled_(std::move(points))
{}

const std::vector<std::size_t>&
MiniBatches::next(Random& random)
{
  if (sampling_ == MiniBatchSampling::WithReplacement) {
    for (auto& index : batch_)
      index = random.index(shuffled_.size());
    return batch_;
  }
  if (shuffled_.size() - num_dealt_ < batch_.size())
    num_dealt_ = 0;
  deal(batch_.size(), random);
  return batch_;
}

const std::vector<std::size_t>&
MiniBatches::subset(std::size_t size, Random& random)
{
  if (size >= shuffled_.size())
    return shuffled_;
  num_dealt_ = 0;
  deal(size, random);
  return batch_;
}

/** Fisher-Yates, as far as the batch needs it: uniform whatever the order left by the
 * last one. What lies before num_dealt_ has been used in this epoch. */
void
MiniBatches::deal(std::size_t size, Random& random)
{
  batch_.resize(size);
  for (auto& index : batch_) {
    const std::size_t pick = num_dealt_ + random.index(shuffled_.size() - num_dealt_);
    std::swap(shuffled_[num_dealt_], shuffled_[pick]);
    index = shuffled_[num_dealt_++];
  }
}

} // namespace bayesian_icp
