/** \file
 * \brief Clouds that lie in a plane, like those of a 2-D laser scanner. They show the
 * motion within the plane. The prior alone says how far they are tilted or shifted out
 * of it.
 */
#pragma once

#include "calibrated/surface/surface_model.h"
#include "geometry/twist.h"
#include "sampler/chain_set.h"

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief \p prior with a hold if both clouds lie in a plane: the planes coincide.
 * Otherwise \p prior. */
HeldPrior
heldInPlane(const Prior& prior, const SurfaceModel& source, const SurfaceModel& target);

/** \brief Give each draw of a flat cloud's motion a tilt and a shift out of the plane.
 * They come from \p prior, given the motion within the plane. The pivot of the tilt is
 * the prior's reference point, projected to the plane.
 *
 * \param[in] prior without a plane
 * \param[in] held heldInPlane() of the prior
 * \param[in] seed of the run
 * \param[in,out] chains draws of the posterior of \p held */
void
addMotionOutOfPlane(const Prior& prior,
                    const HeldPrior& held,
                    std::uint64_t seed,
                    ChainSet& chains);

/** \brief Whether a motion of flat clouds is a shift or a tilt out of their plane.
 * \param[in] twist left, about a point of the plane, target frame */
bool
isOutOf(const PlaneHold& plane, const Vector6d& twist);

/** \brief Doubt of a flat source on a target that is not flat, if the prior leaves the
 * tilt open: the source may fit well with a wrong one. */
std::vector<std::string>
doubtsAboutTilt(const Prior& prior,
                const SurfaceModel& source,
                const SurfaceModel& target);

} // namespace bayesian_icp
