#include "calibrated/calibrated_estimate.h"

#include "algebra/decompositions.h"
#include "calibrated/curvature/curvature.h"
#include "calibrated/free_motions.h"
#include "calibrated/modes/robust_mode.h"
#include "calibrated/score/score_clusters.h"
#include "calibrated/surface/even_choice.h"
#include "calibrated/surface/facing_points.h"
#include "geometry/principal_axes.h"
#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;

namespace {

/** Random stream of the order of points; the streams of chains count from 0. */
constexpr std::uint64_t order_stream = std::uint64_t(1) << 40;

/** More than num_curvature_points are at most this fraction of the cloud, because a
 * choice of nearly all points is as uneven as the cloud, and at most this number per
 * patch of the other cloud: more would repeat the noise of the patches, and J does not
 * see noise that patches share. */
constexpr double max_part_used = 0.4;

/** More than this number of points are at most one per patch of the other cloud. */
constexpr Index min_points_of_few_patches = 250;

/** Limit of the points that face rare motions, as a fraction of the others. */
constexpr double max_share_facing = 0.2;

/** Starts and the mode have converged if a step is below this fraction of the target's
 * noise. */
constexpr double start_tolerance = 0.03;
constexpr double mode_tolerance = 0.01;
constexpr int max_mode_steps = 8;

/** Approximate distance of a point-to-point result from the mode, in units of the
 * distance of the prior's mean. */
constexpr double icp_to_prior_scale = 0.25;

/** Weight of points against the prior in the Gaussian that plans the first secants:
 * neighbouring points repeat each other. */
constexpr double points_to_prior = 0.2;

/** SecantPlan::min_displacement in units of the target's noise. */
constexpr double min_step_to_noise = 0.5;

/** The prior alone holds directions with less information than this along the
 * longestStep(). It is a fifth of the prior's information, and more where the prior is
 * so wide that the steps see but a part of it. Such information would be the remaining
 * noise of a free motion, whose direction would not be turned to follow the surface. */
constexpr double least_information = 0.45;

/** Variance of the score along motions that flat clouds cannot show, in units of the
 * prior's precision: above rounding, and far below all others. */
constexpr double flat_share_of_prior = 1e-9;

/** Along a free motion the score is as unknown as the axis. Its variance grows with the
 * square of the motion, up to this number of squared steps, where points meet new
 * patches. */
constexpr double max_unheld_steps = 1.0;

/** The information is uncertain, because J comes from 12 to 96 clusters, and H from
 * noisy secants. Chosen on simulated scans, docs/lab/calibration.md. */
constexpr int information_degrees_of_freedom = 20;

/** Where the data leave a motion to the prior, the mode moves to the posterior mean if
 * the mean is further away than min_distance_of_mean prior standard deviations, at most
 * max_moves times. It does not move if less than min_support_after_move of the active
 * points would stay active, or if it would fit worse by more than max_loss_of_move of
 * its cost. */
constexpr double min_distance_of_mean = 0.5, min_support_after_move = 0.5;
constexpr double max_loss_of_move = 0.2;
constexpr int max_moves = 2;

/** Further away than max_distance_to_radius of the source's root mean square radius,
 * the points may meet another side of the body, or its end. The mode moves there only
 * if the fit may have slid to where the views overlap most. Then the mean is more than
 * min_distance_of_far_mean prior standard deviations away, and less than
 * max_overlap_before_far_move of the points have a patch at the mode. Where the fit
 * from the mean ends, points must miss their patches by less than
 * max_misfit_after_far_move times as much as at the mode. */
constexpr double max_distance_to_radius = 0.6;
constexpr double min_distance_of_far_mean = 1.5;
constexpr double max_overlap_before_far_move = 0.9, max_misfit_after_far_move = 1.15;

/** Ends of the two starts. The better one leads to the mode. */
struct Ends {
  RobustFit best, other;
};

/** Initial tau, at which a start sees all of the target that the prior allows. It is at
 * most the source's root mean square radius, because a small body would only see a
 * blur. */
double
startScale(const HeldPrior& prior, const SurfaceScorer& scorer)
{
  const double radius = radiusOf(displacementMetric(scorer, Isometry3d::Identity()));
  return std::min(radius, std::sqrt(prior.variance().head<3>().maxCoeff())) /
         scorer.noise();
}

Ends
followStarts(const SurfaceScorer& scorer,
             const HeldPrior& prior,
             const EstimateOptions& options,
             const Isometry3d* start)
{
  const SurfaceScorer subset = scorer.ofFirst(options.num_mode_points);
  RobustFitOptions fit;
  fit.tolerance = start_tolerance * scorer.noise();
  Ends ends;
  if (start) {
    ends.best = ends.other = fitRobustly(subset, prior, *start, fit);
    return ends;
  }
  const Isometry3d prior_mean = isometryOf(prior.mean());
  fit.start_scale = startScale(prior, subset);
  forEachPiece(2, options.num_threads, [&](std::ptrdiff_t i) {
    if (i == 0) {
      ends.best = fitRobustly(subset, prior, prior_mean, fit);
      return;
    }
    const RobustFit icp = fitPointToPoint(subset, prior, prior_mean);
    RobustFitOptions from_icp = fit;
    from_icp.start_scale *= icp_to_prior_scale;
    ends.other = fitRobustly(subset, prior, icp.pose, from_icp);
  });
  return ends;
}

RobustFit
fitOnAllPoints(const SurfaceScorer& scorer,
               const HeldPrior& prior,
               const Isometry3d& start,
               const Matrix6d& hold = Matrix6d::Zero())
{
  RobustFitOptions fit;
  fit.hold = hold;
  fit.max_steps = max_mode_steps;
  fit.tolerance = mode_tolerance * scorer.noise();
  return fitRobustly(scorer, prior, start, fit);
}

/** Follow the ends on more points. Ends that are one place, to within the target's
 * noise, are followed once. */
void
followEnds(const SurfaceScorer& scorer, const HeldPrior& prior, Ends& ends)
{
  const auto putBetterFirst = [&ends] {
    if (relativeCost(ends.other, ends.best) < 1.0)
      std::swap(ends.best, ends.other);
  };
  putBetterFirst();
  const double noise = scorer.noise();
  const Vector6d way =
      twistBetween(ends.best.pose, ends.other.pose, ends.best.pose * scorer.centroid());
  const bool are_apart =
      way.dot(displacementMetric(scorer, ends.best.pose) * way) > noise * noise;
  ends.best = fitOnAllPoints(scorer, prior, ends.best.pose);
  if (!are_apart) {
    ends.other = ends.best;
    return;
  }
  ends.other = fitOnAllPoints(scorer, prior, ends.other.pose);
  putBetterFirst();
}

/** Covariance whose principal axes, in the displacement metric, are the first
 * directions: that of independent points, plus the target's noise. (If the noise were
 * the smallest width instead, all widths would be the same on most scenes, and rounding
 * would decide the directions.) */
Matrix6d
firstCovariance(const CalibratedEstimate& estimate, double noise)
{
  const double weight =
      points_to_prior / (estimate.residual_scale * estimate.residual_scale);
  const Matrix6d covariance =
      (weight * estimate.scores.information + estimate.prior.precision).inverse();
  const PrincipalAxes principal(covariance, estimate.displacement_metric);
  const Vector6d variances = principal.variances.array() + noise * noise;
  return principal.axes * variances.asDiagonal() * principal.axes.transpose();
}

/** J plus the noise of the secants whose directions the data do not hold: where the
 * pose is unknown, the score is unknown, too. */
Matrix6d
withUnheldNoise(const Matrix6d& score_covariance,
                const Secants& secants,
                const DebitedInformation& debited,
                const Matrix6d& covariance)
{
  const Matrix6d to_steps = secants.steps.inverse();
  const Matrix6d in_steps = to_steps * covariance * to_steps.transpose();
  Matrix6d J = score_covariance;
  for (int k = 0; k < 6; ++k)
    J += (1.0 - debited.keep[k]) * std::min(max_unheld_steps, in_steps(k, k)) *
         secants.noise[static_cast<std::size_t>(k)];
  return J;
}

/** Set everything that follows from J, the curvature and the directions. */
void
finish(CalibratedEstimate& e)
{
  const Eigen::LDLT<Matrix6d> J(e.score_covariance);
  e.transfer = transferOf(e.directions, e.keep);
  const Matrix6d HT = e.curvature * e.transfer;
  const Matrix6d weights = HT.transpose() * J.solve(Matrix6d::Identity());
  e.information = weights * HT;
  e.information = symmetrized(e.information);
  e.covariance = (e.information + e.prior.precision).inverse();
  e.covariance = symmetrized(e.covariance);
  e.degrees_of_freedom = information_degrees_of_freedom;
  e.mean = -e.covariance * (weights * e.scores.total + e.prior.gradient);
}

/** The estimate with everything that is evaluated at the mode. */
CalibratedEstimate
atMode(const SurfaceScorer& scorer, const HeldPrior& prior, const RobustFit& mode)
{
  CalibratedEstimate e;
  e.mode = mode.pose;
  e.centre = e.mode * scorer.centroid();
  e.residual_scale = mode.residual_scale;
  PatchHints hints;
  scorer.evaluate(e.mode, e.centre, e.residual_scale, hints, e.scores);
  e.cost = meanCappedResidual(e.scores);
  e.prior = twistPrior(prior, e.mode, e.centre);
  e.displacement_metric = displacementMetric(scorer, e.mode);
  return e;
}

/** The least information along each step. */
Vector6d
leastInformation(const Matrix6d& steps, const CalibratedEstimate& e)
{
  Vector6d least;
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = steps.col(k);
    const double length = std::sqrt(step.dot(e.displacement_metric * step));
    const double part =
        length / longestStep(step / length, e.prior.precision, e.displacement_metric);
    least[k] = least_information * part * part;
  }
  return least;
}

/** Debit the noise of the secants, and set keep, covariance and score_covariance. */
void
debit(const Secants& secants, const Matrix6d& J, CalibratedEstimate& e)
{
  const Vector6d least = leastInformation(secants.steps, e);
  e.score_covariance = J;
  for (int pass = 0; pass < 2; ++pass) {
    const DebitedInformation debited =
        debitedInformation(secants, e.score_covariance, least);
    e.keep = debited.keep;
    e.covariance = (debited.information + e.prior.precision).inverse();
    if (pass == 0)
      e.score_covariance = withUnheldNoise(J, secants, debited, e.covariance);
  }
}

/** J of the points of \p scorer at an estimate's mode. Scores are exactly zero along
 * motions out of the plane of flat clouds. The fraction of the prior makes J regular
 * there, and their information zero. */
ScoreCovariance
scoreCovarianceAt(const CalibratedEstimate& e,
                  const SurfaceScorer& scorer,
                  const HeldPrior& prior,
                  int num_threads)
{
  const Matrix6d fit_precision =
      e.residual_scale * e.residual_scale * e.prior.precision;
  ScoreCovariance J = scoreCovariance(
      activeScores(e.scores, scorer.pointsAt(e.mode)), fit_precision, num_threads);
  if (prior.plane)
    J.covariance += flat_share_of_prior * fit_precision;
  return J;
}

/** Measure rounds of secants, each along the axes found by the round before. \return
 * those of the last round, whose noise is debited */
Secants
measureCurvature(const SurfaceScorer& scorer,
                 const Matrix6d& J,
                 const EstimateOptions& options,
                 CalibratedEstimate& e)
{
  const double noise = scorer.noise(), tau = e.residual_scale;
  e.covariance = firstCovariance(e, noise);
  Secants secants;
  for (int round = 0; round < options.num_rounds; ++round) {
    const SecantPlan plan = {e.covariance,
                             e.displacement_metric,
                             e.prior.precision,
                             min_step_to_noise * noise,
                             options.num_threads};
    secants = measureSecants(scorer, e.mode, e.scores, tau, plan, secants);
    debit(secants, J, e);
  }
  return secants;
}

/** The estimate about one mode. */
CalibratedEstimate
estimateAt(const SurfaceScorer& scorer,
           const HeldPrior& prior,
           const EstimateOptions& options,
           const RobustFit& mode)
{
  CalibratedEstimate e = atMode(scorer, prior, mode);
  // 4: J.
  const ScoreCovariance J = scoreCovarianceAt(e, scorer, prior, options.num_threads);
  e.kappa_48 = J.kappa_48;
  e.kappa_inf = J.kappa_inf;
  // 5: H; 6: what noise explains of it, and what is free; 7: mean and covariance.
  const SurfaceScorer first = scorer.ofFirstOfBoth(options.num_curvature_points);
  CalibratedEstimate of_first = atMode(first, prior, mode);
  const ScoreCovariance J_first =
      scoreCovarianceAt(of_first, first, prior, options.num_threads);
  const Secants secants =
      measureCurvature(first, J_first.covariance, options, of_first);
  const double num_ratio =
      double(e.scores.num_active) / std::max(1, of_first.scores.num_active);
  e.score_covariance =
      J.covariance + num_ratio * J.kappa / J_first.kappa *
                         (of_first.score_covariance - J_first.covariance);
  e.curvature = num_ratio * secants.curvature;
  e.keep = of_first.keep;
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = secants.steps.col(k);
    e.directions.col(k) = step / std::sqrt(step.dot(e.displacement_metric * step));
  }
  turnFreeDirections(first,
                     prior,
                     contactsOf(cappedResiduals(of_first.scores)).misfit,
                     options.num_threads,
                     e);
  finish(e);
  return e;
}

/** Distance of the mean from the mode in prior standard deviations. */
double
priorDistanceOfMean(const CalibratedEstimate& e)
{
  return std::sqrt(e.mean.dot(e.prior.precision * e.mean));
}

/** Whether the mean is so near that points meet the same side of the body. */
bool
isMeanWithinReach(const CalibratedEstimate& e)
{
  return std::sqrt(e.mean.dot(e.displacement_metric * e.mean)) <
         max_distance_to_radius * radiusOf(e.displacement_metric);
}

/** Whether the mode has to move to the mean, because the surface may bend on the way
 * and another mode may be near. */
bool
isFarFromMean(const CalibratedEstimate& e)
{
  const double distance = priorDistanceOfMean(e);
  if (e.keep.minCoeff() > 0.0 || distance <= min_distance_of_mean)
    return false;
  return isMeanWithinReach(e) ||
         (distance > min_distance_of_far_mean &&
          contactsOf(cappedResiduals(e.scores)).share < max_overlap_before_far_move);
}

/** Move the estimate to the mode nearest to the mean. In the \p last move the free
 * directions stay at the mean, because the fit slides back along a motion that is held
 * falsely, and the other motions are wrong there. \return whether it has moved */
bool
moveToMean(const SurfaceScorer& scorer,
           const SurfaceScorer& leading,
           const HeldPrior& prior,
           const EstimateOptions& options,
           bool last,
           CalibratedEstimate& e)
{
  const double tolerance = mode_tolerance * scorer.noise();
  const RobustFit mode =
      fitOnAllPoints(leading,
                     prior,
                     movedBy(e.mean, e.centre, e.mode),
                     last ? holdOfFree(e, tolerance) : Matrix6d::Zero());
  const RobustFit before = fitAt(leading, prior, e.mode);
  if (isClearlyWorse(mode, before, max_loss_of_move) ||
      (!isMeanWithinReach(e) &&
       !(contactsOf(mode.residuals).misfit <
         max_misfit_after_far_move * contactsOf(before.residuals).misfit)))
    return false;
  CalibratedEstimate next = estimateAt(scorer, prior, options, mode);
  const bool moves =
      next.scores.num_active >= min_support_after_move * e.scores.num_active;
  if (moves)
    e = std::move(next);
  return moves;
}

/** Both lists, each in its order, at random places among each other. */
std::vector<Index>
merged(const std::vector<Index>& a, const std::vector<Index>& b, Random& random)
{
  std::vector<Index> both;
  both.reserve(a.size() + b.size());
  for (auto of_a = a.begin(), of_b = b.begin(); both.size() < a.size() + b.size();) {
    const auto left_of_b = static_cast<std::size_t>(b.end() - of_b);
    both.push_back(random.index(a.size() + b.size() - both.size()) < left_of_b
                       ? *of_b++
                       : *of_a++);
  }
  return both;
}

} // namespace

void
setPrior(const Prior& prior, CalibratedEstimate& estimate)
{
  estimate.prior = twistPrior(prior, estimate.mode, estimate.centre);
  finish(estimate);
}

Matrix3Xd
evenPoints(const Matrix3Xd& points,
           const std::vector<Index>& used,
           const SurfaceModel& own,
           const SurfaceModel& other,
           Index max_points,
           std::uint64_t seed)
{
  const Index num_first = std::clamp<Index>(static_cast<Index>(other.patches().size()),
                                            min_points_of_few_patches,
                                            EstimateOptions().num_curvature_points);
  const auto part = static_cast<Index>(
      max_part_used *
      static_cast<double>(std::min(used.size(), other.patches().size())));
  max_points = std::min(max_points, std::max(num_first, part));
  const Eigen::Matrix3Xf relative = relativeTo(centroidOf(points, used), points, used);
  const auto choose = [&](Index count) {
    return evenChoice(relative, count, ChoiceStream::Points);
  };
  Random random(seed, order_stream);
  std::vector<Index> columns = choose(std::min(max_points, num_first));
  shuffle(columns, random);
  std::vector<bool> is_chosen(used.size());
  for (const Index column : columns)
    is_chosen[static_cast<std::size_t>(column)] = true;
  std::vector<Index> others;
  if (max_points > num_first)
    others = choose(max_points);
  shuffle(others, random);
  for (const Index column : others)
    if (!is_chosen[static_cast<std::size_t>(column)] &&
        static_cast<Index>(columns.size()) < max_points) {
      columns.push_back(column);
      is_chosen[static_cast<std::size_t>(column)] = true;
    }
  std::vector<Index> facing = pointsFacingRareMotions(points, used, own);
  shuffle(facing, random);
  const auto max_facing =
      static_cast<std::size_t>(max_share_facing * static_cast<double>(columns.size()));
  std::vector<Index> fresh;
  for (const Index column : facing)
    if (!is_chosen[static_cast<std::size_t>(column)] && fresh.size() < max_facing)
      fresh.push_back(column);
  columns = merged(columns, fresh, random);
  for (Index& column : columns)
    column = used[static_cast<std::size_t>(column)];
  return points(Eigen::all, columns);
}

SurfaceScorer
scorerOf(const Matrix3Xd& source_points,
         const PreparedSurface& source,
         const Matrix3Xd& target_points,
         const PreparedSurface& target,
         Index max_points,
         std::uint64_t seed,
         int num_threads,
         const Reach& reach)
{
  const bool are_both_compared =
      source.complaint.empty() &&
      source.model.planeNormal().has_value() == target.model.planeNormal().has_value();
  Matrix3Xd of_source, of_target;
  forEachPiece(2, num_threads, [&](std::ptrdiff_t cloud) {
    if (cloud == 0)
      of_source = evenPoints(
          source_points, source.columns, source.model, target.model, max_points, seed);
    else if (are_both_compared)
      of_target = evenPoints(target_points,
                             columnsWithin(reach, target_points, target.columns),
                             target.model,
                             source.model,
                             max_points,
                             seed);
  });
  SurfaceScorer scorer(of_source, target.model, num_threads);
  if (source.model.planeNormal() && !target.model.planeNormal())
    scorer.setRayPlane(*source.model.planeNormal());
  if (source.complaint.empty())
    scorer.setSourceNoise(source.model);
  if (are_both_compared)
    scorer.addTargetPoints(of_target, source.model);
  return scorer;
}

CalibratedEstimate
estimateCalibrated(const SurfaceScorer& scorer,
                   const HeldPrior& prior,
                   const EstimateOptions& options,
                   const Isometry3d* start,
                   const SurfaceScorer* leading)
{
  const SurfaceScorer& lead = leading ? *leading : scorer;
  // Numbers are those of the sections of docs/calibration.md. 3: the mode.
  Ends ends = followStarts(lead, prior, options, start);
  followEnds(lead.ofFirst(options.num_curvature_points), prior, ends);
  const RobustFit mode = fitOnAllPoints(lead, prior, ends.best.pose);
  CalibratedEstimate e = estimateAt(scorer, prior, options, mode);
  for (int move = 0; move < max_moves && isFarFromMean(e); ++move)
    if (!moveToMean(scorer, lead, prior, options, move + 1 == max_moves, e))
      break;
  e.other_end = twistBetween(ends.best.pose, ends.other.pose, e.centre);
  e.other_cost_ratio = relativeCost(ends.other, ends.best);
  return e;
}

} // namespace bayesian_icp
