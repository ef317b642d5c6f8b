/** \file
 * \brief A seeded generator whose numbers do not depend on the standard library.
 */
#pragma once

#include <bayesian_icp/export.h>

#include <Eigen/Core>

#include <cstdint>
#include <random>
#include <vector>

namespace bayesian_icp {

/** \brief Random numbers of one stream, determined by (seed, stream) alone.
 *
 * std::mt19937_64 seeded through std::seed_seq: both are fixed by the C++ standard,
 * while std::normal_distribution and std::uniform_int_distribution are not.
 */
class BAYESIAN_ICP_EXPORT Random {
public:
  Random(std::uint64_t seed, std::uint64_t stream);

  /** \brief Uniform in [0, 1) with 53 random bits. */
  double
  uniform();

  /** \brief Uniform integer in 0 .. bound - 1, without bias; \p bound must be positive.
   */
  std::size_t
  index(std::size_t bound);

  /** \brief Standard normal variate (Marsaglia's polar method). */
  double
  normal();

  /** \brief Six independent standard normal variates. */
  Eigen::Matrix<double, 6, 1>
  normal6();

private:
  std::mt19937_64 engine_;
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

/** \brief \p size different numbers of 0 ... count - 1 in random order, so that any
 * part of them is a random choice as well; all of them in random order if there are
 * fewer. */
BAYESIAN_ICP_EXPORT std::vector<Eigen::Index>
randomChoice(Eigen::Index count, Eigen::Index size, Random& random);

} // namespace bayesian_icp
