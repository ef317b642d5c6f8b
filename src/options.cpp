#include "options/enumerator_names.h"
#include "options/option_checker.h"

#include <bayesian_icp/options.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** In a scan, the sensor is the origin, and at most this multiple of the radius away
 * from the centroid: a wall that fills a field of view of 28 by 28 degrees. If it is
 * further away, the cloud is an object that a sensor sees. */
constexpr double max_distance_of_sensor = 5.0;

/** Where finite points are. */
struct PointSpread {
  explicit PointSpread(const Eigen::Matrix3Xd& points)
  {
    double num_finite = 0.0, sum_of_squares = 0.0;
    for (const auto& point : points.colwise())
      if (point.allFinite())
        centroid += (point - centroid) / ++num_finite;
    for (const auto& point : points.colwise())
      if (point.allFinite())
        sum_of_squares += (point - centroid).squaredNorm();
    radius = std::sqrt(sum_of_squares / num_finite);
  }

  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  /** Root mean square distance from the centroid [m]. */
  double radius = 0.0;
};

void
check(const PriorOptions& prior, Preset preset, Checker& checker)
{
  const bool must_be_finite = preset == Preset::Calibrated;
  const char* names[] = {"prior.variance[x]",
                         "prior.variance[y]",
                         "prior.variance[z]",
                         "prior.variance[roll]",
                         "prior.variance[pitch]",
                         "prior.variance[yaw]"};
  // Smaller ones drown in the rounding of sums with the precision of other directions.
  constexpr double min_variance = 1e-24;
  for (int k = 0; k < 6; ++k) {
    checker.require(prior.variance[k] >= min_variance,
                    names[k],
                    prior.variance[k],
                    k < 3 ? "positive, and at least 1e-24 (m^2)"
                          : "positive, and at least 1e-24 (rad^2)");
    checker.require(!must_be_finite || std::isfinite(prior.variance[k]),
                    names[k],
                    prior.variance[k],
                    "finite for preset calibrated: it is the posterior where the "
                    "clouds say nothing");
  }
  checker.require(prior.mean.allFinite() || prior.mean.array().isNaN().all(),
                  "prior.mean",
                  prior.mean.transpose(),
                  "six finite numbers (m, rad)");
  checker.oneOf("PriorFrame", "prior.frame", prior.frame);
}

void
check(const ChainOptions& chains, Checker& checker)
{
  checker.atLeast("num_chains", chains.num_chains, 1);
  checker.require(chains.num_draws >= chains.num_chains,
                  "num_draws",
                  chains.num_draws,
                  "at least the number of chains (one draw a chain)");
  const std::string most = "at most " + std::to_string(max_draws);
  checker.require(
      chains.num_draws <= max_draws, "num_draws", chains.num_draws, most.c_str());
  checker.atLeast("num_threads", chains.num_threads, 0);
}

void
check(const LikelihoodScale& scale, Checker& checker)
{
  checker.positive("effective_points", scale.effective_points);
  checker.positive("measurement_sigma", scale.measurement_sigma, " (m)");
}

/** Automatic values are given as good ones. */
void
checkSteps(int num_burn_in, int thinning, Checker& checker)
{
  checker.atLeast("num_burn_in", num_burn_in, 0);
  checker.atLeast("thinning", thinning, 1);
}

void
checkSpread(const Vector6d& spread, Checker& checker)
{
  checker.require(spread.allFinite() && spread.minCoeff() >= 0.0,
                  "initial_spread",
                  spread.transpose(),
                  "six finite numbers not below zero (m, rad)");
}

void
checkGate(double max_distance, Checker& checker)
{
  checker.require(max_distance > 0.0,
                  "max_distance",
                  max_distance,
                  "positive (m), infinity is none");
}

void
check(const SgldOptions& sgld, Checker& checker)
{
  checker.positive("step_size", sgld.step_size);
  checker.require(sgld.decay_rate >= 0.0 && sgld.decay_rate < 1.0,
                  "decay_rate",
                  sgld.decay_rate,
                  "in [0, 1)");
  checker.positive("lambda_rms", sgld.lambda_rms);
  checker.require(sgld.noise_factor >= 0.0 && std::isfinite(sgld.noise_factor),
                  "noise_factor",
                  sgld.noise_factor,
                  "not negative and finite");
  checker.require(sgld.block_decay_factor > 0.0 && sgld.block_decay_factor <= 1.0,
                  "block_decay_factor",
                  sgld.block_decay_factor,
                  "in (0, 1]");
  checker.atLeast("block_decay_interval", sgld.block_decay_interval, 1);
  checker.require(sgld.block_decay_start >= 0.0 && sgld.block_decay_start <= 1.0,
                  "block_decay_start",
                  sgld.block_decay_start,
                  "in [0, 1] (fraction of a chain's steps)");
}

void
check(const PaperOptions& paper, Checker& checker)
{
  check(paper.scale, checker);
  checker.atLeast("batch_size", paper.batch_size, 1);
  checker.oneOf("MiniBatchSampling", "sampling", paper.sampling);
  check(paper.sgld, checker);
  checkGate(paper.max_distance, checker);
  checkSteps(paper.num_burn_in, paper.thinning, checker);
  checkSpread(paper.initial_spread, checker);
}

void
check(const ExactOptions& exact, int num_chains, Checker& checker)
{
  check(exact.scale, checker);
  checker.oneOf("Residual", "residual", exact.residual.residual);
  checker.oneOf(
      "CovarianceRegularization", "regularization", exact.residual.regularization);
  checker.oneOf("RobustKernel", "kernel", exact.residual.kernel);
  checker.positive("kernel_width", exact.residual.kernel_width, " (m)");
  checkGate(exact.residual.max_distance, checker);
  checker.atLeast("batch_size", exact.batch_size.valueOr(1), 1);
  checker.oneOf("ExactSteps", "steps", exact.steps);
  checker.require(!exact.batch_size.isGiven() || exact.steps == ExactSteps::Automatic ||
                      exact.steps == ExactSteps::Langevin,
                  "steps",
                  toString(exact.steps),
                  "automatic or langevin with a batch_size: other steps evaluate the "
                  "whole source");
  if (usesParticles(exact.steps))
    checker.atLeast(
        "num_particles", exact.num_particles, std::max(min_particles, num_chains));
  checker.require(exact.max_step_size > 0.0 && exact.max_step_size <= 1.0,
                  "max_step_size",
                  exact.max_step_size,
                  "in (0, 1] (1 is a Newton step)");
  checkSteps(exact.num_burn_in.valueOr(0), exact.thinning.valueOr(1), checker);
  checkSpread(exact.initial_spread.valueOr(Vector6d::Zero()), checker);
  checker.atLeast("max_source_points", exact.max_source_points, 1);
}

void
check(const CalibratedOptions& calibrated, Checker& checker)
{
  checker.atLeast("calibrated.max_source_points",
                  calibrated.max_source_points,
                  min_calibrated_points);
  checker.atLeast(
      "calibrated.num_mode_points", calibrated.num_mode_points, min_calibrated_points);
  checkSteps(
      calibrated.num_burn_in.valueOr(0), calibrated.thinning.valueOr(1), checker);
}

} // namespace

const char*
toString(Preset preset)
{
  return nameOf(preset, {"paper", "exact", "calibrated"});
}

const char*
toString(MiniBatchSampling sampling)
{
  return nameOf(sampling, {"with-replacement", "shuffled-epochs"});
}

const char*
toString(Residual residual)
{
  return nameOf(residual,
                {"point-to-point", "point-to-plane", "distribution-to-distribution"});
}

const char*
toString(CovarianceRegularization regularization)
{
  return nameOf(regularization, {"plane", "frobenius", "none"});
}

const char*
toString(RobustKernel kernel)
{
  return nameOf(kernel, {"none", "huber", "tukey"});
}

const char*
toString(ExactSteps steps)
{
  return nameOf(
      steps, {"automatic", "langevin", "metropolis", "stein-gradient", "stein-newton"});
}

PriorFrame
priorFrameOf(const Options& options, const Eigen::Matrix3Xd& source_points)
{
  if (options.prior.frame != PriorFrame::Automatic)
    return options.prior.frame;
  if (options.preset != Preset::Calibrated)
    return PriorFrame::Origin;
  const PointSpread source(source_points);
  return source.centroid.norm() <= max_distance_of_sensor * source.radius
             ? PriorFrame::Origin
             : PriorFrame::SourceCentroid;
}

Prior
priorOf(const Options& options,
        const Vector6d& initial_pose,
        const Eigen::Matrix3Xd& source_points)
{
  const PriorOptions& prior = options.prior;
  const Vector6d& mean = prior.mean.allFinite() ? prior.mean : initial_pose;
  if (priorFrameOf(options, source_points) == PriorFrame::Origin)
    return Prior(mean, prior.variance);
  return Prior(mean, prior.variance, PointSpread(source_points).centroid);
}

std::string
Options::validate() const
{
  Checker checker;
  checker.oneOf("Preset", "preset", preset);
  check(prior, preset, checker);
  check(chains, checker);
  switch (preset) {
  case Preset::Paper:
    check(paper, checker);
    break;
  case Preset::Exact:
    check(exact, chains.num_chains, checker);
    break;
  case Preset::Calibrated:
    check(calibrated, checker);
    break;
  }
  return checker.complaint();
}

} // namespace bayesian_icp
