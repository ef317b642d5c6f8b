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

/** \brief Random numbers of one stream, which depend on (seed, stream) alone.
 *
 * It uses std::mt19937_64 seeded by std::seed_seq, because the C++ standard fixes both.
 * It does not fix std::normal_distribution and std::uniform_int_distribution. */
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

/** \brief Choose \p size different numbers of 0 ... count - 1 in random order. Any part
 * of them is a random choice again. If there are fewer numbers than \p size, all of
 * them are returned in random order. */
BAYESIAN_ICP_EXPORT std::vector<Eigen::Index>
randomChoice(Eigen::Index count, Eigen::Index size, Random& random);

} // namespace bayesian_icp
