/** \file
 * \brief Internal: fast sorting of values that are spread evenly.
 */
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Sort the \p count least of \p keys to the front of \p sorted: into buckets of
 * equal width, and then those.
 * \param[in] placeOf from a key to a float or double in [0, 1], in the order of the
 * keys \param[out] sorted all keys \param[in,out] buckets a buffer */
template <typename Key, typename Place>
void
sortInBuckets(const std::vector<Key>& keys,
              std::size_t count,
              const Place& placeOf,
              std::vector<Key>& sorted,
              std::vector<std::uint32_t>& buckets)
{
  const std::size_t num_buckets = keys.size();
  const auto bucketOf = [&](const Key& key) {
    const auto place = placeOf(key);
    const auto last = static_cast<decltype(place)>(num_buckets - 1);
    return std::min(static_cast<std::size_t>(place * last), num_buckets - 1);
  };
  buckets.assign(num_buckets, 0);
  for (const Key& key : keys)
    ++buckets[bucketOf(key)];
  std::uint32_t sum = 0;
  for (auto& bucket : buckets) { // where it ends ...
    sum += bucket;
    bucket = sum;
  }
  sorted.resize(keys.size());
  for (const Key& key : keys)
    sorted[--buckets[bucketOf(key)]] = key; // ... and, in the end, begins
  const auto begin = sorted.begin();
  for (std::size_t bucket = 0; bucket < num_buckets; ++bucket) {
    const std::size_t first = buckets[bucket];
    if (first >= count)
      break;
    const std::size_t last =
        bucket + 1 < num_buckets ? buckets[bucket + 1] : sorted.size();
    if (last - first > 1)
      std::sort(begin + static_cast<std::ptrdiff_t>(first),
                begin + static_cast<std::ptrdiff_t>(last));
  }
}

} // namespace bayesian_icp
