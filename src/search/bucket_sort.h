/** \file
 * \brief Internal: fast sorting of values that are spread evenly.
 */
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Sort \p keys into buckets of equal width, and then those.
 *
 * \param[in] placeOf from a key to a float or double in [0, 1], in the order of the
 *            keys
 * \param[out] sorted the keys
 * \param[in,out] buckets a buffer */
template <typename Key, typename Place>
void
sortInBuckets(const std::vector<Key>& keys,
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
  std::uint32_t sum = 0, largest = 0;
  for (auto& bucket : buckets) { // where it ends ...
    largest = std::max(largest, bucket);
    sum += bucket;
    bucket = sum;
  }
  sorted.resize(keys.size());
  for (const Key& key : keys)
    sorted[--buckets[bucketOf(key)]] = key; // ... and, in the end, begins
  if (largest > 32) {                       // dense clusters: insertion is quadratic
    std::sort(sorted.begin(), sorted.end());
    return;
  }
  // Insertion moves keys within their buckets only.
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const Key key = sorted[i];
    std::size_t place = i;
    for (; place > 0 && key < sorted[place - 1]; --place)
      sorted[place] = sorted[place - 1];
    sorted[place] = key;
  }
}

} // namespace bayesian_icp
