#include "calibrated/modes/calibrated_modes.h"

#include "calibrated/draws/product_coordinates.h"
#include "calibrated/modes/look_alikes.h"
#include "calibrated/modes/mode_weights.h"
#include "calibrated/modes/robust_mode.h"
#include "calibrated/modes/translated_fits.h"
#include "calibrated/surface/even_choice.h"
#include "geometry/principal_axes.h"
#include "threads/for_each_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;

namespace {

/** A prior is wide above these standard deviations: [rad], and as a fraction of the
 * source's extent. */
constexpr double wide_angle = 0.2, wide_part_of_extent = 0.25;

/** Cost of the first estimate above which there may be a better mode within a narrow
 * prior: more than a quarter of the points do not meet the target, or fit badly. Of
 * simulated scans with full overlap, nine in ten stay below 1.7, and hardly any is
 * above 2. Scans that lost half of the overlap are above. */
constexpr double doubtful_cost = 2.0;

/** Starts reach this far, in standard deviations. Further out, they would be further
 * from likely places of the truth than the prior's mean is. */
constexpr double reach = 1.75;

/** Above lost_angle, a standard deviation of a rotation [rad], a start rarely has both
 * the right rotation and the right place, so hops follow. They have num_slide_pairs
 * pairs of opposite slides, of the lengths below in deviations of the prior. */
constexpr double lost_angle = 0.5;
constexpr int num_slide_pairs = 6;
constexpr double shortest_slide = 0.15, longest_slide = 1.5;
/** In such a prior, what the sensor sees depends on the mode. It changes by regions of
 * this fraction of a cloud. */
constexpr double region_of_cloud = 1.0 / 40.0;

/** Point-to-point ICP on icp_part of the points brings a start near. The robust fit
 * then begins with a scale of sight times the source's root mean square radius. */
constexpr double icp_part = 0.5, sight = 0.1;

/** An end of a start is ignored if its cost is above the best one's by more than this
 * fraction, or if it is within these squared Mahalanobis distances of a known mode. The
 * first distance is for ends on a few points, the second for estimates. */
constexpr double cost_margin = 0.35;
constexpr double min_squared_distance = 200.0, min_squared_distance_of_modes = 100.0;
/** A mode does not hide an end that costs less by this fraction: the deviations of a
 * mode that fits badly are so large that they may reach to a better one. */
constexpr double hiding_margin = 0.05;

/** The first estimate is ignored if its cost is above the best end's by this fraction.
 * It then went astray, for example to where few points meet the target. There it leaves
 * motions to the prior along which it would seem to be the same mode as the right one.
 */
constexpr double astray_margin = 0.2;

/** The target's points lead if they cost less than this times what the source's cost.
 */
constexpr double max_cost_to_lead = 0.7;

/** An end is ignored if its squared distance from the prior's mean is above this, in
 * standard deviations, and further than that of the first estimate. Where little of the
 * clouds overlaps, a wrong place may fit better than the right one. */
constexpr double max_squared_deviations = 36.0;

/** A prior so many times as wide does not keep the fit from a place where the clouds
 * meet. */
constexpr double widening = 10.0;

/** For the path that connects two modes: fit steps at each place, and the largest
 * distance of the surface from the straight path, as a fraction of its length. */
constexpr int num_way_steps = 6;
constexpr double max_aside = 0.15;

/** Smallest share of the posterior of a mode that is kept. */
constexpr double min_share = 0.02;

/** A mode is within another one if its squared Mahalanobis distance from it is below
 * this, the 99 % quantile of the chi-square distribution with 6 degrees of freedom. */
constexpr double region_of_mode = 16.81;

std::array<bool, 6>
wideCoordinates(const SurfaceScorer& scorer, const HeldPrior& prior)
{
  const double extent = extentOf(scorer.sourcePoints());
  std::array<bool, 6> wide;
  for (int k = 0; k < 6; ++k)
    wide[static_cast<std::size_t>(k)] =
        std::sqrt(prior.variance()[k]) >
        (k < 3 ? wide_part_of_extent * extent : wide_angle);
  return wide;
}

bool
isWide(const SurfaceScorer& scorer, const HeldPrior& prior)
{
  const auto wide = wideCoordinates(scorer, prior);
  return std::any_of(wide.begin(), wide.end(), [](bool is_wide) { return is_wide; });
}

/** The pose of a deviation (as in Prior::deviation()) from the prior's mean. */
Isometry3d
poseAt(const Vector6d& deviation, const HeldPrior& prior)
{
  Vector6d pose = prior.mean() + deviation;
  const Eigen::Vector3d reference = isometryOf(prior.mean()) * prior.referencePoint();
  pose.head<3>() =
      reference + deviation.head<3>() - rotationOf(pose) * prior.referencePoint();
  return isometryOf(pose);
}

/** Starts over the prior: a Latin hypercube in the wide coordinates, draws in the
 * others. */
std::vector<Isometry3d>
startsOver(const HeldPrior& prior,
           const std::array<bool, 6>& wide,
           int num_starts,
           Random& random)
{
  Matrix6Xd deviations(6, num_starts);
  for (int k = 0; k < 6; ++k) {
    const double sd = std::sqrt(prior.variance()[k]);
    std::vector<Index> strata(static_cast<std::size_t>(num_starts));
    std::iota(strata.begin(), strata.end(), Index(0));
    shuffle(strata, random);
    const double range = k < 3 ? reach * sd : std::min(M_PI, reach * sd);
    for (Index i = 0; i < num_starts; ++i) {
      const double share = (static_cast<double>(strata[static_cast<std::size_t>(i)]) +
                            random.uniform()) /
                           num_starts;
      deviations(k, i) = wide[static_cast<std::size_t>(k)] ? (2.0 * share - 1.0) * range
                                                           : sd * random.normal();
    }
  }
  std::vector<Isometry3d> starts;
  for (const auto deviation : deviations.colwise())
    starts.push_back(poseAt(deviation, prior));
  return starts;
}

/** Whether the prior's rotation is very wide. */
bool
mayBeLost(const HeldPrior& prior)
{
  return std::sqrt(prior.variance().tail<3>().maxCoeff()) > lost_angle;
}

/** Starts where the target may look much as it does at \p pose: slides, since many
 * places have steps, pillars or shelves, and half turns about the source's principal
 * axes. */
std::vector<Isometry3d>
hopsFrom(const Isometry3d& pose,
         const SurfaceScorer& scorer,
         const HeldPrior& prior,
         Random& random)
{
  std::vector<Isometry3d> starts;
  for (int i = 0; i < num_slide_pairs; ++i) {
    Eigen::Vector3d slide;
    for (double& coordinate : slide)
      coordinate = random.normal();
    const double step = (i + random.uniform()) / num_slide_pairs;
    slide *=
        shortest_slide * std::pow(longest_slide / shortest_slide, step) / slide.norm();
    slide.array() *= prior.variance().head<3>().array().sqrt();
    starts.push_back(Eigen::Translation3d(slide) * pose);
    starts.push_back(Eigen::Translation3d(-slide) * pose);
  }
  const Eigen::Translation3d centroid(scorer.centroid());
  const Eigen::Matrix3Xd arms =
      scorer.leadingPoints(pose).colwise() - scorer.centroid();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(arms *
                                                                 arms.transpose());
  for (int k = 0; k < 3; ++k)
    starts.push_back(pose * centroid *
                     Eigen::AngleAxisd(M_PI, principal.eigenvectors().col(k)) *
                     centroid.inverse());
  return starts;
}

/** An estimate of a mode, and how well a few points fit there. */
struct KnownMode {
  ProductCoordinates coordinates;
  Isometry3d pose;
  RobustFit fit;
};

/** Squared Mahalanobis distance of a pose from a mode, for the mode's clouds alone. */
double
squaredDistance(const ProductCoordinates& mode, const Isometry3d& pose)
{
  return 2.0 * mode.linearEnergy(mode.heldPart(pose));
}

/** Whether a path along motions that the prior alone holds leads from one mode to the
 * other on the surface. Their own axes cannot tell: they are not exact, and far along
 * them each mode is off the other's axis. */
bool
areConnected(const SurfaceScorer& subset,
             const HeldPrior& prior,
             const CalibratedEstimate& from,
             const CalibratedEstimate& to,
             double max_cost)
{
  if (from.keep.minCoeff() > 0.0 || to.keep.minCoeff() > 0.0)
    return false;
  const Vector6d way = twistBetween(from.mode, to.mode, from.centre);
  const double noise = subset.noise();
  const double length = std::sqrt(way.dot(from.displacement_metric * way));
  RobustFitOptions fit;
  fit.max_steps = num_way_steps;
  fit.tolerance = 0.1 * noise;
  for (const double part : {0.25, 0.5, 0.75}) {
    const Isometry3d start = movedBy(part * way, from.centre, from.mode);
    // This prior keeps the fit near its start.
    const HeldPrior here = prior.with(poseOf(start.matrix()), prior.variance());
    const RobustFit end = fitRobustly(subset, here, start, fit);
    const Vector6d aside = twistBetween(start, end.pose, from.centre);
    if (end.cost > max_cost || std::sqrt(aside.dot(from.displacement_metric * aside)) >
                                   max_aside * length + noise)
      return false;
  }
  return true;
}

/** Where starts end. */
std::vector<RobustFit>
followStarts(const SurfaceScorer& subset,
             const HeldPrior& prior,
             const std::vector<Isometry3d>& starts,
             int num_threads)
{
  const double noise = subset.noise();
  const double radius = radiusOf(displacementMetric(subset, Isometry3d::Identity()));
  const auto num_icp_points =
      static_cast<Index>(icp_part * static_cast<double>(subset.numPoints()));
  const SurfaceScorer icp_points = subset.ofFirst(num_icp_points);
  RobustFitOptions fit;
  fit.start_scale =
      std::min(sight * radius, std::sqrt(prior.variance().head<3>().maxCoeff())) /
      noise;
  fit.max_steps = 20;
  fit.tolerance = 0.1 * noise;
  std::vector<RobustFit> ends(starts.size());
  forEachPiece(starts.size(), num_threads, [&](std::size_t i) {
    const RobustFit icp = fitPointToPoint(icp_points, prior, starts[i]);
    ends[i] = fitRobustly(subset, prior, icp.pose, fit);
  });
  return ends;
}

bool
costsLess(const RobustFit& a, const RobustFit& b)
{
  return a.cost < b.cost;
}

/** Where starts over the prior end, and, if the source may be lost, hops from the best
 * of these ends. Least cost first. */
std::vector<RobustFit>
endsOfStarts(const SurfaceScorer& subset,
             const HeldPrior& prior,
             const std::array<bool, 6>& wide,
             const RobustFit& first,
             const ModeSearchOptions& options)
{
  const int num_threads = options.estimate.num_threads;
  Random random(options.seed, std::numeric_limits<std::uint64_t>::max() / 2);
  std::vector<RobustFit> ends = followStarts(
      subset, prior, startsOver(prior, wide, options.num_starts, random), num_threads);
  if (mayBeLost(prior)) {
    const auto best = std::min_element(ends.begin(), ends.end(), costsLess);
    const bool is_first = best == ends.end() || costsLess(first, *best);
    const auto hops =
        hopsFrom(is_first ? first.pose : best->pose, subset, prior, random);
    const std::vector<RobustFit> more = followStarts(subset, prior, hops, num_threads);
    ends.insert(ends.end(), more.begin(), more.end());
  }
  std::stable_sort(ends.begin(), ends.end(), costsLess);
  return ends;
}

/** Squared distance of a pose from the prior's mean, in standard deviations. */
double
squaredDeviations(const SurfaceScorer& scorer,
                  const HeldPrior& prior,
                  const Isometry3d& pose)
{
  const TwistPrior there = twistPrior(prior, pose, pose * scorer.centroid());
  return there.deviation.dot(there.precision * there.deviation);
}

/** Whether the prior has more to say about some direction than the clouds. */
bool
doesPriorHold(const CalibratedEstimate& e)
{
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> relative(
      e.information, e.prior.precision, Eigen::EigenvaluesOnly);
  return !(relative.eigenvalues()[0] > 1.0);
}

/** See CalibratedEstimate::better_fit. */
double
betterFitOf(const SurfaceScorer& scorer,
            const HeldPrior& prior,
            const CalibratedEstimate& estimate,
            const ModeSearchOptions& options)
{
  const SurfaceScorer subset = scorer.ofFirst(options.num_points);
  const HeldPrior wide =
      prior.with(prior.mean(), widening * widening * prior.variance());
  const std::vector<RobustFit> ends =
      followStarts(subset,
                   wide,
                   {isometryOf(prior.mean()), estimate.mode},
                   options.estimate.num_threads);
  const auto best = std::min_element(ends.begin(), ends.end(), costsLess);
  if (!isClearlyWorse(fitAt(subset, prior, estimate.mode), *best, astray_margin))
    return 0.0;
  return squaredDeviations(subset, prior, best->pose);
}

/** The two directions in which the posterior's translation is widest. */
std::vector<Eigen::Vector3d>
weakTranslations(const CalibratedEstimate& e)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(
      Eigen::Matrix3d(e.covariance.topLeftCorner<3, 3>()));
  return {principal.eigenvectors().col(2), principal.eigenvectors().col(1)};
}

/** Where the search ends that follows some points. */
struct CloudEnds {
  SurfaceScorer subset;
  /** At the mode of the first estimate. */
  RobustFit first;
  /** Where starts and hops end, least cost first. */
  std::vector<RobustFit> others;

  double
  leastCost() const
  {
    return others.empty() ? first.cost : std::min(first.cost, others.front().cost);
  }
};

/** \param[in] leading its first points are followed */
CloudEnds
endsOfCloud(const SurfaceScorer& leading,
            const SurfaceScorer& scorer,
            const HeldPrior& prior,
            const CalibratedEstimate& first,
            const ModeSearchOptions& options)
{
  const SurfaceScorer subset = leading.ofFirst(options.num_points);
  CloudEnds ends = {subset, fitAt(subset, prior, first.mode), {}};
  std::vector<RobustFit>& others = ends.others;
  if (mayHaveSeveralModes(scorer, prior, first))
    others = endsOfStarts(
        subset, prior, wideCoordinates(scorer, prior), ends.first, options);
  const auto add = [&](const std::vector<RobustFit>& found) {
    others.insert(others.end(), found.begin(), found.end());
    std::stable_sort(others.begin(), others.end(), costsLess);
  };
  const auto best = [&] {
    return others.empty() || costsLess(ends.first, others.front()) ? ends.first
                                                                   : others.front();
  };
  const int num_threads = options.estimate.num_threads;
  add(endsAtRepeats(subset, prior, best(), weakTranslations(first), num_threads));
  add(endsOnParallelFaces(leading, subset, prior, best(), num_threads));
  const double max_squared = std::max(
      max_squared_deviations, squaredDeviations(scorer, prior, ends.first.pose));
  others.erase(std::remove_if(others.begin(),
                              others.end(),
                              [&](const RobustFit& end) {
                                return squaredDeviations(scorer, prior, end.pose) >
                                       max_squared;
                              }),
               others.end());
  return ends;
}

/** Add an estimate of the mode at each of the ends, unless it is known.
 * \param[in] leading as in estimateCalibrated()
 * \param[in,out] modes none but the first estimate */
void
addModes(const SurfaceScorer& scorer,
         const SurfaceScorer* leading,
         const HeldPrior& prior,
         const CloudEnds& ends,
         const ModeSearchOptions& options,
         std::vector<CalibratedMode>& modes)
{
  const double max_cost = (1.0 + cost_margin) * ends.leastCost();
  std::vector<KnownMode> known;
  for (const CalibratedMode& mode : modes)
    known.push_back(
        {ProductCoordinates(mode.estimate), mode.estimate.mode, ends.first});
  for (const RobustFit& end : ends.others) {
    if (end.cost > max_cost || static_cast<int>(modes.size()) >= options.max_modes)
      break;
    const auto isWorse = [&end](const KnownMode& mode) {
      return isClearlyWorse(mode.fit, end, hiding_margin);
    };
    if (std::any_of(known.begin(), known.end(), [&](const KnownMode& mode) {
          return squaredDistance(mode.coordinates, end.pose) < min_squared_distance &&
                 !isWorse(mode);
        }))
      continue;
    const CalibratedEstimate estimate =
        estimateCalibrated(scorer, prior, options.estimate, &end.pose, leading);
    const KnownMode found = {ProductCoordinates(estimate), estimate.mode, end};
    const bool is_known =
        std::any_of(known.begin(), known.end(), [&](const KnownMode& mode) {
          constexpr double limit = min_squared_distance_of_modes;
          return squaredDistance(mode.coordinates, estimate.mode) < limit &&
                 (squaredDistance(found.coordinates, mode.pose) < limit ||
                  !isWorse(mode));
        });
    if (!is_known && std::any_of(modes.begin(), modes.end(), [&](const auto& mode) {
          return areConnected(ends.subset, prior, mode.estimate, estimate, max_cost);
        }))
      continue;
    known.push_back(found);
    if (!is_known)
      modes.push_back({estimate, 0.0});
  }
}

/** Add the modes to which the target's points lead, if they fit far better than the
 * source's. Those of a scan do if the source is a model of all of the body, or if it
 * was seen from more sides.
 * \param[in] least_cost what the source's points cost where they fit best
 * \return whether they do */
bool
addModesOfTarget(const SurfaceScorer& scorer,
                 const HeldPrior& prior,
                 const CalibratedEstimate& first,
                 double least_cost,
                 const ModeSearchOptions& options,
                 std::vector<CalibratedMode>& modes)
{
  const bool is_target_compared = scorer.numPoints() > scorer.sourcePoints().cols();
  if (first.cost < doubtful_cost || !is_target_compared)
    return false;
  const SurfaceScorer target = scorer.ofTarget();
  CloudEnds ends = endsOfCloud(target, scorer, prior, first, options);
  if (ends.leastCost() > max_cost_to_lead * least_cost)
    return false;
  ends.others.push_back(ends.first);
  std::stable_sort(ends.others.begin(), ends.others.end(), costsLess);
  addModes(scorer, &target, prior, ends, options, modes);
  return true;
}

} // namespace

bool
mayHaveSeveralModes(const SurfaceScorer& scorer,
                    const HeldPrior& prior,
                    const CalibratedEstimate& first)
{
  return first.cost > doubtful_cost || isWide(scorer, prior);
}

std::vector<CalibratedMode>
findModes(const SurfaceScorer& scorer,
          const HeldPrior& prior,
          const CalibratedEstimate& first,
          const ModeSearchOptions& options)
{
  std::vector<CalibratedMode> modes;
  const CloudEnds ends = endsOfCloud(scorer, scorer, prior, first, options);
  if (!addModesOfTarget(scorer, prior, first, ends.leastCost(), options, modes)) {
    if (ends.others.empty() || first.keep.minCoeff() > 0.0 ||
        !isClearlyWorse(ends.first, ends.others.front(), astray_margin))
      modes.push_back({first, 0.0});
    addModes(scorer, nullptr, prior, ends, options, modes);
  }
  weighModes(prior,
             mayBeLost(prior) ? region_of_cloud : 0.0,
             unseenPoints(scorer, modes),
             modes);
  return modes;
}

std::vector<CalibratedMode>
significantModes(std::vector<CalibratedMode> modes)
{
  const std::vector<double> shares = sharesOf(modes);
  const auto num_large = std::count_if(
      shares.begin(), shares.end(), [](double share) { return share >= min_share; });
  modes.erase(modes.begin() + num_large, modes.end());
  return modes;
}

std::vector<CalibratedMode>
separateModes(std::vector<CalibratedMode> modes)
{
  for (std::size_t wide = 0; wide < modes.size(); ++wide) {
    const ProductCoordinates region(modes[wide].estimate);
    for (std::size_t other = modes.size(); other-- > 0;) {
      const bool is_within =
          squaredDistance(region, modes[other].estimate.mode) < region_of_mode;
      if (other == wide || !is_within)
        continue;
      modes.erase(modes.begin() + static_cast<std::ptrdiff_t>(other));
      wide -= other < wide;
    }
  }
  return modes;
}

std::vector<CalibratedMode>
calibratedModes(const SurfaceScorer& scorer,
                const HeldPrior& prior,
                const ModeSearchOptions& options)
{
  const CalibratedEstimate first = estimateCalibrated(scorer, prior, options.estimate);
  std::vector<CalibratedMode> modes =
      separateModes(significantModes(findModes(scorer, prior, first, options)));
  CalibratedEstimate& heaviest = modes.front().estimate;
  if (!isWide(scorer, prior) && doesPriorHold(heaviest))
    heaviest.better_fit = betterFitOf(scorer, prior, heaviest, options);
  return modes;
}

} // namespace bayesian_icp
