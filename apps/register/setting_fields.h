/** \file
 * \brief The one table of settings: their names on the command line and in
 * configuration files, and their descriptions. Presets with a setting of the same name
 * have it under the same option and key.
 */
#pragma once

#include "register/field.h"
#include "register/settings.h"

#include <limits>

namespace bayesian_icp::app {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// clang-format off
/** \brief Call visit(field, value) for the settings of the registration. */
template <typename SettingsT, typename Visitor>
void
visitRegistration(SettingsT& settings, Visitor&& visit)
{
  constexpr const char* group = "registration";
  visit({group, "guess_matrix", "guess", "POSE|FILE",
         "Initial guess of the source-to-target pose: x,y,z,roll,pitch,yaw [m, rad] "
         "with R = Rz(yaw) Ry(pitch) Rx(roll); a text file with the 4x4 matrix; or a "
         "posterior.json (a name that ends in .json), whose mean it is."},
        settings.guess);
  visit({group, "max_distance_m", "max-distance,d", "M",
         "Largest distance of corresponding points [m]. With preset calibrated it "
         "applies to ICP only.",
         infinite, true}, settings.max_distance);
  visit({group, "icp_iterations", "iterations,i", "N",
         "Largest number of iterations of ICP."}, settings.icp_iterations);
  visit({group, "reciprocal", "reciprocal", "",
         "Use only pairs in which each point is the nearest one to the other. Without "
         "it, each source point is paired with its nearest target point."},
        settings.is_reciprocal);
  visit({group, "one_to_one", "one-to-one", "",
         "Keep only one pair for each target point, that with the nearest source point. "
         "Without it, a target point may be in several pairs."},
        settings.is_one_to_one);
  visit({group, "use_mean", "mean", "",
         "Take the posterior mean as the final transformation if the status is ok, "
         "doubtful or not mixed. Without it, the final transformation is ICP's result."},
        settings.use_mean);
}

/** \brief Call visit(field, value) for the settings of the posterior. */
template <typename OptionsT, typename Visitor>
void
visitPosterior(OptionsT& options, Visitor&& visit)
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
         "origin than 5 times the root mean square distance of the points from the "
         "centroid."},
        options.prior.frame);
}

/** \brief Call visit(field, value) for what the chains of all presets have in common.
 */
template <typename ChainsT, typename Visitor>
void
visitChains(ChainsT& chains, Visitor&& visit)
{
  visit({"chains", "num_chains", "chains", "N",
         "Number of independent chains."}, chains.num_chains);
  visit({"chains", "num_draws", "samples", "N",
         "Number of draws to keep, over all chains."}, chains.num_draws);
  visit({"chains", "seed", "seed", "N",
         "Seed of all random numbers, 0 to 2^64-1."}, chains.seed);
  visit({"chains", "num_threads", "threads", "N",
         "Number of threads. 0 means OpenMP's default, one per processor. The draws do "
         "not depend on it."}, chains.num_threads);
}

/** \brief Call visit(field, value) for the stated scale of presets `paper` and `exact`.
 */
template <typename ScaleT, typename Visitor>
void
visitScale(ScaleT& scale, Visitor&& visit)
{
  visit({"posterior", "effective_points", "effective-points", "N",
         "N of the paper's eq. (5): weight of the likelihood, not the size of the "
         "cloud."}, scale.effective_points);
  visit({"posterior", "measurement_sigma_m", "sigma", "M",
         "Standard deviation of a point-to-point distance [m]."},
        scale.measurement_sigma);
}

/** \brief Call visit(field, value) for the lengths of the chains. */
template <typename PresetT, typename Visitor>
void
visitLengths(PresetT& preset, Visitor&& visit)
{
  visit({"chains", "num_burn_in", "burn-in", "N",
         "Number of steps at the start of each chain that are not kept."},
        preset.num_burn_in);
  visit({"chains", "thinning", "thinning", "N",
         "Number of steps for each kept draw."}, preset.thinning);
}

/** \brief Call visit(field, value) for the settings of preset `paper`. */
template <typename SettingsT, typename Visitor>
void
visitPaper(SettingsT& settings, Visitor&& visit)
{
  auto& paper = settings.options.paper;
  visitScale(paper.scale, visit);
  visitLengths(paper, visit);
  visit({"chains", "initial_spread_m_rad", "initial-spread", "LIST",
         "Standard deviation of the chains' starts about the guess, "
         "x,y,z,roll,pitch,yaw [m, rad]: six numbers, or one for all."},
        paper.initial_spread);
  visit({"mini_batch", "batch_size", "batch-size", "N",
         "Number of source points in each step."}, paper.batch_size);
  visit({"mini_batch", "sampling", "batch-sampling", "NAME",
         "How the source points of a step are chosen."}, paper.sampling);
  // The constants of Algorithm 1.
  auto& sgld = paper.sgld;
  visit({"sgld", "step_size", "step-size", "A",
         "Step size alpha of eqs. (5), (8), (9)."}, sgld.step_size);
  visit({"sgld", "decay_rate", "decay-rate", "B",
         "Share beta of the old squared gradient that eq. (10) keeps."},
        sgld.decay_rate);
  visit({"sgld", "lambda_rms", "lambda-rms", "L",
         "Constant lambda of eq. (11), which keeps the preconditioner finite [m, "
         "m^2/rad]."}, sgld.lambda_rms);
  visit({"sgld", "noise_factor", "noise-factor", "F",
         "Factor on the variance of the injected noise."}, sgld.noise_factor);
  visit({"sgld", "block_decay_factor", "block-decay-factor", "F",
         "Multiply the step size by F every --block-decay-interval steps at the end of "
         "a chain. 1 turns this off."}, sgld.block_decay_factor);
  visit({"sgld", "block_decay_interval", "block-decay-interval", "N",
         "Number of steps between two reductions of the step size."},
        sgld.block_decay_interval);
  visit({"sgld", "block_decay_start", "block-decay-start", "P",
         "Where these reductions begin, as a fraction of the steps of a chain."},
        sgld.block_decay_start);
  visit({"registration", "normalize_cloud", "normalize-cloud", "",
         "Divide both clouds by their largest |x|, |y| or |z| before the registration. "
         "--sigma (1 unless stated), --step-size and --lambda-rms are then in units of "
         "that length; everything else and all results are in metres. Without it, all "
         "lengths are in metres."}, settings.is_normalized);
}

/** \brief Call visit(field, value) for the settings of preset `exact`. The gate of its
 * residual is that of the registration. */
template <typename SettingsT, typename Visitor>
void
visitExact(SettingsT& settings, Visitor&& visit)
{
  auto& exact = settings.options.exact;
  visitScale(exact.scale, visit);
  visitLengths(exact, visit);
  visit({"chains", "initial_spread_m_rad", "initial-spread", "LIST",
         "Standard deviation of the chains' starts about the guess, "
         "x,y,z,roll,pitch,yaw [m, rad]: six numbers, or one for all. automatic is as "
         "wide as the prior, but at most 0.5."}, exact.initial_spread);
  visit({"mini_batch", "batch_size", "batch-size", "N",
         "Number of source points in each Langevin step, without replacement. A number "
         "selects Langevin steps."}, exact.batch_size);
  visit({"exact", "max_step_size", "max-step-size", "B",
         "Largest size of a Langevin step, at most 1, which is a Newton step."},
        exact.max_step_size);
  visit({"exact", "steps", "steps", "NAME",
         "How draws are made. Metropolis steps are exact where small mini-batches are "
         "too noisy for Langevin steps. Stein steps move particles, which replace the "
         "draws."}, exact.steps);
  visit({"exact", "num_particles", "particles", "N",
         "Number of particles of Stein steps."}, exact.num_particles);
  visit({"exact", "residual", "residual", "NAME",
         "Distance to penalize: from a source point to its nearest target point, along "
         "the target's normal there, or in units of both neighbourhoods' covariances "
         "(GICP)."}, exact.residual.residual);
  visit({"exact", "regularization", "regularization", "NAME",
         "How these covariances are regularised: as planes, as in fast_gicp, or not at "
         "all."},
        exact.residual.regularization);
  visit({"exact", "kernel", "kernel", "NAME",
         "Robust kernel on that distance, against outliers."}, exact.residual.kernel);
  visit({"exact", "kernel_width_m", "kernel-width", "M",
         "Distance from which a robust kernel differs from the square (huber) or is "
         "constant (tukey) [m]."}, exact.residual.kernel_width);
  visit({"exact", "max_source_points", "max-source-points", "N",
         "Largest number of source points. A larger source is thinned evenly over its "
         "order."}, exact.max_source_points);
}

/** \brief Call visit(field, value) for the settings of preset `calibrated`. */
template <typename SettingsT, typename Visitor>
void
visitCalibrated(SettingsT& settings, Visitor&& visit)
{
  auto& calibrated = settings.options.calibrated;
  visitLengths(calibrated, visit);
  visit({"calibrated", "max_source_points", "calibrated-points", "N",
         "Largest number of points of each cloud. Of a larger cloud, this many points "
         "that cover it evenly are used, and up to a fifth more of those that alone hold "
         "a motion, like that along a tunnel."}, calibrated.max_source_points);
  visit({"calibrated", "num_mode_points", "mode-points", "N",
         "Number of these source points with which the starts are followed to a mode."},
        calibrated.num_mode_points);
}

// clang-format on
/** \brief Call visit(field, value) for the settings of \p preset. */
template <typename SettingsT, typename Visitor>
void
visitPreset(Preset preset, SettingsT& settings, Visitor&& visit)
{
  switch (preset) {
  case Preset::Paper:
    return visitPaper(settings, visit);
  case Preset::Exact:
    return visitExact(settings, visit);
  case Preset::Calibrated:
    return visitCalibrated(settings, visit);
  }
}

/** \brief Call visit(field, value) for every setting that there is with the preset,
 * which itself comes before those that depend on it. */
template <typename SettingsT, typename Visitor>
void
visitSettings(SettingsT& settings, Visitor&& visit)
{
  visitRegistration(settings, visit);
  visitPosterior(settings.options, visit);
  visitChains(settings.options.chains, visit);
  visitPreset(settings.options.preset, settings, visit);
}

} // namespace bayesian_icp::app
