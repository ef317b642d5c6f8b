/** \file
 * \brief Mini-batches: which source points one step of the sampler looks at.
 */
#pragma once

#include <bayesian_icp/options.h>
#include <bayesian_icp/random.h>

#include <vector>

namespace bayesian_icp {

/** \brief The stream of mini-batches of one chain: all that a sampler draws from its
 * points is drawn here. */
class MiniBatches {
public:
  /** \param[in] num_points size n of the source, positive
   * \param[in] batch_size m of Algorithm 1; more than n is taken as n
   * \param[in] sampling how a batch is drawn */
  MiniBatches(std::size_t num_points,
              std::size_t batch_size,
              MiniBatchSampling sampling);

  /** \param[in] points for subset() */
  explicit MiniBatches(std::vector<std::size_t> points);

  /** \brief Indices into the source of the next batch; valid until the next call. */
  const std::vector<std::size_t>&
  next(Random& random);

  /** \brief So many of the points, none twice, whatever was drawn before; without
   * random numbers all of them if there are no more. Valid until the next call. */
  const std::vector<std::size_t>&
  subset(std::size_t size, Random& random);

private:
  void
  deal(std::size_t size, Random& random);

  MiniBatchSampling sampling_ = MiniBatchSampling::ShuffledEpochs;
  std::vector<std::size_t> shuffled_;
  std::size_t num_dealt_ = 0;
  std::vector<std::size_t> batch_;
};

} // namespace bayesian_icp
