/** \file
 * \brief A random part of a cloud.
 */
#pragma once

#include <bayesian_icp/random.h>

#include <vector>

namespace bayesian_icp::evaluate {

/** \brief \p size different numbers of 0 ... count - 1 in random order; all of them in
 * random order if there are fewer. */
std::vector<Eigen::Index>
randomPart(Eigen::Index count, Eigen::Index size, Random& random);

} // namespace bayesian_icp::evaluate
