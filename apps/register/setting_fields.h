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
         "initial guess of the source-to-target pose: x,y,z,roll,pitch,yaw [m, rad], "
         "or a "
         "text file with the 4x4 matrix; R = Rz(yaw) Ry(pitch) Rx(roll)"},
        settings.guess);
  visit({group,
         "max_distance_m",
         "max-distance,d",
         "M",
         "largest distance of corresponding points [m]; with calibrated for ICP only",
         infinite,
         true},
        settings.max_distance);
  visit({group,
         "icp_iterations",
         "iterations,i",
         "N",
         "largest number of ICP's iterations"},
        settings.icp_iterations);
  visit({group,
         "reciprocal",
         "reciprocal",
         "",
         "use only pairs of points that are nearest to each other"},
        settings.is_reciprocal);
  visit({group,
         "one_to_one",
         "one-to-one",
         "",
         "use a target point for the nearest of its source points only"},
        settings.is_one_to_one);
  visit(
      {group,
       "normalize_cloud",
       "normalize-cloud",
       "",
       "divide both clouds by their largest |x|, |y|, |z| before they are registered, "
       "with preset paper only: --sigma (1), --step-size and --lambda-rms are then in "
       "units of that length, everything else and all results in metres"},
      settings.is_normalized);
  visit(
      {group,
       "use_mean",
       "mean",
       "",
       "take the posterior mean in place of ICP's result as the final transformation, "
       "unless the status is worse than not mixed"},
      settings.use_mean);
}

/** \brief Call visit(field, value) for the settings of the posterior. */
template <typename OptionsT, typename Visitor>
void
visitPosterior(OptionsT& options, Visitor& visit)
{
  visit(
      {"posterior",
       "preset",
       "preset",
       "NAME",
       "Algorithm 1 literally, a sampler that is right for the stated posterior, or a "
       "scale found from the clouds"},
      options.preset);
  visit(
      {"posterior",
       "effective_points",
       "effective-points",
       "N",
       "N of the paper's eq. (5): weight of the likelihood, not the size of the cloud"},
      options.likelihood.effective_points);
  visit({"posterior",
         "measurement_sigma_m",
         "sigma",
         "M",
         "standard deviation of a point-to-point distance [m]"},
        options.likelihood.measurement_sigma);
  visit({"prior",
         "mean_m_rad",
         "prior-mean",
         "POSE",
         "prior mean x,y,z,roll,pitch,yaw [m, rad] (default: the guess)",
         not_a_number,
         true},
        options.prior.mean);
  visit(
      {"prior",
       "variance_m2_rad2",
       "prior-variance",
       "LIST",
       "prior variance of x,y,z [m^2] and roll,pitch,yaw [rad^2]: six numbers, or one "
       "for all; inf is no prior, which calibrated does not take",
       infinite,
       true},
      options.prior.variance);
  visit({"prior",
         "frame",
         "prior-frame",
         "NAME",
         "the point whose translation the prior describes; automatic: the origin, or "
         "with preset calibrated the source's centroid if that is further from the "
         "origin than 1.5 times the points' root mean square distance from it"},
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
