#include "calibrated/free_motions.h"

#include "algebra/decompositions.h"
#include "calibrated/curvature/curvature.h"
#include "calibrated/modes/robust_mode.h"
#include "threads/for_each_piece.h"

#include <array>
#include <cmath>

namespace bayesian_icp {

using Eigen::Isometry3d;

namespace {

/** Initial scale of Tukey's weight in units of the target's noise: a tilted direction
 * may lead as far off the surface. */
constexpr double start_scale = 10.0;
constexpr int max_steps = 10;

/** In units of the target's noise: how exactly a fit keeps its place along the free
 * directions, and the step at which it has converged. */
constexpr double hold_tolerance = 0.01, fit_tolerance = 0.03;

/** At an end, points miss their patches by at most max_misfit times as much as at the
 * mode. Otherwise the length is multiplied by shortening, down to shortest times the
 * target's noise: on a shorter way the noise of the ends would turn the direction. */
constexpr double max_misfit = 1.2, shortening = 1.0 / 3.0, shortest = 3.0;

/** Let direction \p k lead from one end to the other of two fits, which start at \p
 * length to both sides of the mode. \return whether both ends fit; if not, the
 * direction does not change */
bool
turnDirection(int k,
              double length,
              const SurfaceScorer& scorer,
              const HeldPrior& prior,
              double misfit,
              int num_threads,
              CalibratedEstimate& e)
{
  const double noise = scorer.noise();
  RobustFitOptions options;
  options.start_scale = start_scale;
  options.max_steps = max_steps;
  options.tolerance = fit_tolerance * noise;
  options.hold = holdOfFree(e, hold_tolerance * noise);
  const Vector6d step = length * e.directions.col(k);
  std::array<RobustFit, 2> ends;
  forEachPiece(ends.size(), num_threads, [&](std::size_t i) {
    const Isometry3d start = movedBy(i == 0 ? step : Vector6d(-step), e.centre, e.mode);
    ends[i] = fitRobustly(scorer, prior, start, options);
  });
  for (const RobustFit& end : ends)
    if (!(contactsOf(end.residuals).misfit <= max_misfit * misfit))
      return false;
  const Vector6d way = twistBetween(e.mode, ends[0].pose, e.centre) -
                       twistBetween(e.mode, ends[1].pose, e.centre);
  e.directions.col(k) = way / std::sqrt(way.dot(e.displacement_metric * way));
  return true;
}

} // namespace

Matrix6d
holdOfFree(const CalibratedEstimate& estimate, double tolerance)
{
  const Matrix6d to_directions = estimate.directions.inverse();
  Matrix6d hold = Matrix6d::Zero();
  for (int k = 0; k < 6; ++k)
    if (estimate.keep[k] == 0.0)
      hold += to_directions.row(k).transpose() * to_directions.row(k);
  return hold / (tolerance * tolerance);
}

void
turnFreeDirections(const SurfaceScorer& scorer,
                   const HeldPrior& prior,
                   double misfit,
                   int num_threads,
                   CalibratedEstimate& estimate)
{
  for (int k = 0; k < 6; ++k) {
    if (estimate.keep[k] > 0.0)
      continue;
    double length = longestStep(estimate.directions.col(k),
                                estimate.prior.precision,
                                estimate.displacement_metric);
    while (length > shortest * scorer.noise() &&
           !turnDirection(k, length, scorer, prior, misfit, num_threads, estimate))
      length *= shortening;
  }
}

} // namespace bayesian_icp
