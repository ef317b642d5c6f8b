/** \file
 * \brief The one table of settings: their names on the command line and in
 * configuration files, and their descriptions.
 */
#pragma once

#include "register/calibrated_fields.h"
#include "register/exact_fields.h"
#include "register/field.h"
#include "register/sampler_fields.h"
#include "register/settings.h"

#include <limits>

namespace bayesian_icp::app {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/** \brief Call visit(field, value) for the settings of the registration. */
template <typename SettingsT, typename Visitor>
void
visitRegistration(SettingsT& settings, Visitor& visit)
{
  constexpr const char* group = "registration";
  visit({group,
         "guess_matrix",
         "guess",
         "POSE|FILE",
         "Initial guess of the source-to-target pose: x,y,z,roll,pitch,yaw [m, rad] "
         "with R = Rz(yaw) Ry(pitch) Rx(roll), or a text file with the 4x4 matrix."},
        settings.guess);
  visit({group,
         "max_distance_m",
         "max-distance,d",
         "M",
         "Largest distance of corresponding points [m]. With preset calibrated it "
         "applies to ICP only.",
         infinite,
         true},
        settings.max_distance);
  visit({group,
         "icp_iterations",
         "iterations,i",
         "N",
         "Largest number of iterations of ICP."},
        settings.icp_iterations);
  visit({group,
         "reciprocal",
         "reciprocal",
         "",
         "Use only pairs whose points are nearest to each other. Without it, each "
         "source point is paired with its nearest target point."},
        settings.is_reciprocal);
  visit({group,
         "one_to_one",
         "one-to-one",
         "",
         "Pair each target point with the nearest of its source points only. Without "
         "it, a target point may be in several pairs."},
        settings.is_one_to_one);
  visit({group,
         "normalize_cloud",
         "normalize-cloud",
         "",
         "Divide both clouds by their largest |x|, |y| or |z| before the registration "
         "(preset paper only). --sigma (1 unless stated), --step-size and --lambda-rms "
         "are then in units of that length; everything else and all results are in "
         "metres. Without it, all lengths are in metres."},
        settings.is_normalized);
  visit({group,
         "use_mean",
         "mean",
         "",
         "Take the posterior mean as the final transformation, unless the status is "
         "worse than not mixed. Without it, the final transformation is ICP's result."},
        settings.use_mean);
}

/** \brief Call visit(field, value) for the settings of the posterior. */
template <typename OptionsT, typename Visitor>
void
visitPosterior(OptionsT& options, Visitor& visit)
{
  visit({"posterior",
         "preset",
         "preset",
         "NAME",
         "Posterior to sample: paper is Algorithm 1, literally; exact draws correctly "
         "from the stated posterior; calibrated estimates the scale from the clouds."},
        options.preset);
  visit({"posterior",
         "effective_points",
         "effective-points",
         "N",
         "N of the paper's eq. (5): weight of the likelihood, not the size of the "
         "cloud."},
        options.likelihood.effective_points);
  visit({"posterior",
         "measurement_sigma_m",
         "sigma",
         "M",
         "Standard deviation of a point-to-point distance [m]."},
        options.likelihood.measurement_sigma);
  visit({"prior",
         "mean_m_rad",
         "prior-mean",
         "POSE",
         "Prior mean x,y,z,roll,pitch,yaw [m, rad]. (default: the guess)",
         not_a_number,
         true},
        options.prior.mean);
  visit({"prior",
         "variance_m2_rad2",
         "prior-variance",
         "LIST",
         "Prior variance of x,y,z [m^2] and roll,pitch,yaw [rad^2]: six numbers, or "
         "one for all. inf means no prior; preset calibrated does not accept it.",
         infinite,
         true},
        options.prior.variance);
  visit(
      {"prior",
       "frame",
       "prior-frame",
       "NAME",
       "Point whose translation the prior describes. automatic is origin; with preset "
       "calibrated it is source-centroid if the centroid is further from the origin "
       "than "
       "1.5 times the points' root mean square distance from it."},
      options.prior.frame);
}

/** \brief Call visit(field, value) for every setting. */
template <typename SettingsT, typename Visitor>
void
visitSettings(SettingsT& settings, Visitor& visit)
{
  visitRegistration(settings, visit);
  visitPosterior(settings.options, visit);
  visitSampler(settings.options, visit);
  visitExact(settings.options.exact, visit);
  visitCalibrated(settings.options.calibrated, visit);
}

} // namespace bayesian_icp::app
