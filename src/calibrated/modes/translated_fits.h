/** \file
 * \brief Search for other fits a translation away: on the other one of two parallel
 * faces, and where the target repeats itself.
 */
#pragma once

#include "calibrated/modes/robust_mode.h"

#include <vector>

namespace bayesian_icp {

/** \brief Follow hops from \p from to parallel faces: translations that put points of
 * the source from the faces that they meet onto the next parallel one, such as the
 * other side of a wall, or the next board of a shelf. Hops are repeated from the best
 * end. They are at most three standard deviations of the prior long, and at most a
 * quarter of the source's extent.
 *
 * \param[in] scorer parallel faces are looked for where its first source points are
 * \param[in] subset of its points, which fits compare
 * \param[in] from a fit of the subset
 * \param[in] num_threads 0: as OpenMP would
 * \return ends that cost at most a fifth more than the best of them and \p from */
std::vector<RobustFit>
endsOnParallelFaces(const SurfaceScorer& scorer,
                    const SurfaceScorer& subset,
                    const HeldPrior& prior,
                    const RobustFit& from,
                    int num_threads);

/** \brief Slide the source from \p from along some axes, and follow the places where it
 * fits better than beside them: those of another pillar, parked car or shelf. Slides
 * are as long as the hops above.
 *
 * \param[in] axes unit vectors, target frame
 * \return ends that cost at most a fifth more than \p from */
std::vector<RobustFit>
endsAtRepeats(const SurfaceScorer& subset,
              const HeldPrior& prior,
              const RobustFit& from,
              const std::vector<Eigen::Vector3d>& axes,
              int num_threads);

} // namespace bayesian_icp
