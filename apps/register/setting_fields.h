/** \file
 * \brief The one table of settings: their names on the command line and in
 * configuration files, and their descriptions.
 */
#pragma once

#include "register/field.h"
#include "register/preset_fields.h"
#include "register/settings.h"

#include <limits>

namespace bayesian_icp::app {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// clang-format off
/** \brief Call visit(field, value) for the settings of the registration. */
template <typename SettingsT, typename Visitor>
void
visitRegistration(SettingsT& settings, Visitor& visit)
{
  constexpr const char* group = "registration";
  visit({group, "guess_matrix", "guess", "POSE|FILE",
         "Initial guess of the source-to-target pose: x,y,z,roll,pitch,yaw [m, rad] "
         "with R = Rz(yaw) Ry(pitch) Rx(roll), or a text file with the 4x4 matrix."},
        settings.guess);
  visit({group, "max_distance_m", "max-distance,d", "M",
         "Largest distance of corresponding points [m]. With preset calibrated it "
         "applies to ICP only.",
         infinite, true}, settings.max_distance);
  visit({group, "icp_iterations", "iterations,i", "N",
         "Largest number of iterations of ICP."}, settings.icp_iterations);
  visit({group, "reciprocal", "reciprocal", "",
         "Use only pairs whose points are nearest to each other. Without it, each "
         "source point is paired with its nearest target point."},
        settings.is_reciprocal);
  visit({group, "one_to_one", "one-to-one", "",
         "Pair each target point with the nearest of its source points only. Without "
         "it, a target point may be in several pairs."}, settings.is_one_to_one);
  visit({group, "use_mean", "mean", "",
         "Take the posterior mean as the final transformation, unless the status is "
         "worse than not mixed. Without it, the final transformation is ICP's result."},
        settings.use_mean);
}

/** \brief Call visit(field, value) for the settings of the posterior. */
template <typename OptionsT, typename Visitor>
void
visitPosterior(OptionsT& options, Visitor& visit)
{
  visit({"posterior", "preset", "preset", "NAME",
         "Posterior to sample: paper is Algorithm 1, literally; exact draws correctly "
         "from the stated posterior; calibrated estimates the scale from the clouds."},
        options.preset);
  visit({"prior", "mean_m_rad", "prior-mean", "POSE",
         "Prior mean x,y,z,roll,pitch,yaw [m, rad]. (default: the guess)",
         not_a_number, true}, options.prior.mean);
  visit({"prior", "variance_m2_rad2", "prior-variance", "LIST",
         "Prior variance of x,y,z [m^2] and roll,pitch,yaw [rad^2]: six numbers, or "
         "one for all. inf means no prior; preset calibrated does not accept it.",
         infinite, true}, options.prior.variance);
  visit({"prior", "frame", "prior-frame", "NAME",
         "Point whose translation the prior describes. automatic is origin; with "
         "preset calibrated it is source-centroid if the centroid is further from the "
         "origin than 1.5 times the points' root mean square distance from it."},
        options.prior.frame);
}

/** \brief Call visit(field, value) for what the chains of all presets have in common.
 */
template <typename ChainsT, typename Visitor>
void
visitChains(ChainsT& chains, Visitor& visit)
{
  visit({"chains", "num_chains", "chains", "N",
         "Number of independent chains."}, chains.num_chains);
  visit({"chains", "num_draws", "samples", "N",
         "Number of draws to keep, over all chains."}, chains.num_draws);
  visit({"chains", "seed", "seed", "N",
         "Seed of all random numbers, 0 to 2^64-1."}, chains.seed);
  visit({"chains", "num_threads", "threads", "N",
         "Number of threads. 0 means as many as there are. The draws do not depend on "
         "it."}, chains.num_threads);
}

// clang-format on
/** \brief Call visit(field, value) for every setting that there is with the preset,
 * which itself comes before those that depend on it. */
template <typename SettingsT, typename Visitor>
void
visitSettings(SettingsT& settings, Visitor& visit)
{
  visitRegistration(settings, visit);
  visitPosterior(settings.options, visit);
  visitChains(settings.options.chains, visit);
  visitPreset(settings.options.preset, settings, visit);
}

} // namespace bayesian_icp::app
