#include "calibrated/modes/translated_fits.h"

#include "calibrated/surface/even_choice.h"
#include "threads/for_each_piece.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** Longest hop, in standard deviations of the prior and as a fraction of the diagonal
 * of the source's bounding box. */
constexpr double max_deviations = 3.0, max_part_of_extent = 0.25;
/** Shortest hop, in units of the noise. Nearer faces are one. */
constexpr double min_length_to_noise = 6.0;
/** Smallest cosine of the angle between the normals of parallel faces. */
constexpr double min_cosine = 0.97;

/** Ways are the same if they differ by less than this fraction of their length. */
constexpr double max_difference = 0.15;
/** Number of source points from which ways are looked for. */
constexpr Index num_points_looked_at = 1000;
/** A way counts if it is that of this share of the points that meet the target. Few
 * points are on the thin side of a body, and may alone tell where it is along it. */
constexpr double min_share_of_points = 0.01;
/** Number of ways that are compared with all others to find the commonest. */
constexpr std::size_t max_ways_tried = 250;
/** At most so many kinds of ways are found at a pose, and followed from it. */
constexpr std::size_t max_ways_found = 8, max_ways_followed = 16;

/** The source slides this number of steps along an axis and against it. Of the places
 * where it fits better than a step nearer or further, so many are followed. */
constexpr int num_slides = 30;
constexpr std::size_t max_repeats = 4;
/** Number of slides one after another, in which a point mostly meets the same patches.
 */
constexpr Index slides_per_piece = 8;
/** Residuals count at least up to this one. */
constexpr double least_cap = 5.0;

constexpr int max_rounds = 4, max_fit_steps = 10;
constexpr double max_relative_cost = 1.2;

bool
areSame(const Vector3d& a, const Vector3d& b)
{
  return (a - b).norm() < max_difference * b.norm();
}

double
maxLength(const SurfaceScorer& scorer,
          const HeldPrior& prior,
          const Isometry3d& T_target_source)
{
  return std::min(max_deviations * std::sqrt(prior.variance().head<3>().maxCoeff()),
                  max_part_of_extent * extentOf(scorer.leadingPoints(T_target_source)));
}

/** Finds ways from points on the surface to parallel faces. */
class FaceFinder {
public:
  FaceFinder(const SurfaceScorer& scorer, double max_length)
  : scorer_(scorer)
  , min_length_(min_length_to_noise * scorer.noise())
  , max_length_(max_length)
  {}

  /** The commonest ways from the places of the source's points, along the normals of
   * their patches, target frame [m]. */
  std::vector<Vector3d>
  find(const Isometry3d& T_target_source) const
  {
    PatchHints hints;
    SurfaceScores scores;
    scorer_.evaluate(T_target_source,
                     T_target_source * scorer_.centroid(),
                     std::numeric_limits<double>::infinity(),
                     hints,
                     scores);
    std::vector<Vector3d> ways;
    int num_points = 0;
    for (Index i = 0; i < scorer_.numPoints(); ++i) {
      const auto point = static_cast<std::size_t>(i);
      if (!scores.has_patch[point])
        continue;
      ++num_points;
      const Vector3d place = scorer_.placeOf(i, T_target_source);
      const SurfaceModel& model = scorer_.modelOf(i);
      const Vector3d normal = model.patches()[hints[point]].axes.col(2);
      addWay(model, place, normal, hints[point], ways);
      addWay(model, place, -normal, hints[point], ways);
    }
    // Where the points are the target's, the source moves to meet them.
    if (scorer_.sourcePoints().cols() == 0)
      for (Vector3d& way : ways)
        way = -(T_target_source.linear() * way).eval();
    return commonest(std::move(ways), min_share_of_points * num_points);
  }

private:
  /** Add the way from \p place to the first parallel patch along \p normal. */
  void
  addWay(const SurfaceModel& model,
         const Vector3d& place,
         const Vector3d& normal,
         std::uint32_t hint,
         std::vector<Vector3d>& ways) const
  {
    const auto gate = static_cast<float>(max_length_ * max_length_);
    // No patch is nearer than the nearest one, so steps of its distance miss none.
    for (double length = min_length_; length < max_length_;) {
      const Vector3d here = place + length * normal;
      const KdTree::Neighbor nearest =
          model.tree().nearest(here.cast<float>(), gate, hint);
      scorer_.countQueries(1);
      if (nearest.index == KdTree::none)
        return;
      hint = nearest.index;
      const SurfacePatch& patch = model.patches()[hint];
      const Vector3d offset = patch.origin - place;
      const double along = offset.dot(normal);
      const double aside = (offset - along * normal).norm();
      if (patch.isUsable() && along > min_length_ && along < max_length_ &&
          aside < SurfaceScorer::max_in_plane * patch.radius &&
          std::abs(patch.axes.col(2).dot(normal)) > min_cosine) {
        ways.push_back(along * normal);
        return;
      }
      length += std::max(min_length_, std::sqrt(double(nearest.squared_distance)));
    }
  }

  /** At most max_ways_found that are at least \p min_count times the same, each the
   * mean of its kind; the commonest first. */
  static std::vector<Vector3d>
  commonest(std::vector<Vector3d> ways, double min_count)
  {
    std::vector<Vector3d> common;
    while (!ways.empty() && common.size() < max_ways_found) {
      Index most = 0;
      Vector3d sum = Vector3d::Zero();
      const std::size_t num_tried = std::min(ways.size(), max_ways_tried);
      for (std::size_t i = 0; i < num_tried; ++i) {
        const Vector3d& way = ways[i];
        Index count = 0;
        Vector3d sum_of_same = Vector3d::Zero();
        for (const Vector3d& other : ways)
          if (areSame(other, way)) {
            sum_of_same += other;
            ++count;
          }
        if (count > most) {
          most = count;
          sum = sum_of_same;
        }
      }
      if (static_cast<double>(most) < min_count)
        break;
      const Vector3d mean = sum / static_cast<double>(most);
      common.push_back(mean);
      // Those at the edge of this kind are not another one.
      ways.erase(std::remove_if(ways.begin(),
                                ways.end(),
                                [&](const Vector3d& way) {
                                  return (way - mean).norm() <
                                         2.0 * max_difference * mean.norm();
                                }),
                 ways.end());
    }
    return common;
  }

  const SurfaceScorer& scorer_;
  double min_length_, max_length_;
};

/** Add \p found and the opposite ways to \p ways, unless they are known or there are
 * enough. */
void
addToKnown(const std::vector<Vector3d>& found, std::vector<Vector3d>& ways)
{
  for (const Vector3d& way : found)
    for (const Vector3d& either : {way, Vector3d(-way)})
      if (ways.size() < max_ways_followed &&
          std::none_of(ways.begin(), ways.end(), [&](const Vector3d& known) {
            return areSame(known, either);
          }))
        ways.push_back(either);
}

/** Ways to the places along an axis where the source fits better than beside them,
 * best first. */
std::vector<Vector3d>
repeatsAlong(const Vector3d& axis,
             double step,
             const SurfaceScorer& scorer,
             const RobustFit& from,
             int num_threads)
{
  constexpr Index num_costs = 2 * num_slides + 1;
  const auto wayTo = [&](Index i) {
    return Vector3d(static_cast<double>(i - num_slides) * step * axis);
  };
  // Distances count up to a step, so that no place is missed between two of them.
  const double cap = std::max(least_cap, step / scorer.noise());
  Eigen::Array<double, num_costs, 1> costs;
  constexpr Index num_pieces = (num_costs + slides_per_piece - 1) / slides_per_piece;
  forEachPiece(num_pieces, num_threads, [&](std::ptrdiff_t piece) {
    const Index end = std::min(num_costs, slides_per_piece * (piece + 1));
    PatchHints hints;
    SurfaceScores scores;
    for (Index i = slides_per_piece * piece; i < end; ++i) {
      const Isometry3d pose = Eigen::Translation3d(wayTo(i)) * from.pose;
      scorer.evaluate(pose, pose * scorer.centroid(), 0.0, hints, scores);
      const auto on_patch = scores.residuals.array().abs().min(cap) / cap;
      costs[i] = (on_patch + scores.off_continuation.array()).mean();
    }
  });
  std::vector<Index> repeats;
  for (Index i = 1; i + 1 < num_costs; ++i)
    if (std::abs(i - num_slides) > 1 && costs[i] < costs[i - 1] &&
        costs[i] < costs[i + 1])
      repeats.push_back(i);
  std::stable_sort(repeats.begin(), repeats.end(), [&](Index a, Index b) {
    return costs[a] < costs[b];
  });
  repeats.resize(std::min(repeats.size(), max_repeats));
  std::vector<Vector3d> ways;
  std::transform(repeats.begin(), repeats.end(), std::back_inserter(ways), wayTo);
  return ways;
}

/** \param[in] start_scale as in RobustFitOptions
 */
std::vector<RobustFit>
followHops(const SurfaceScorer& scorer,
           const HeldPrior& prior,
           const Isometry3d& from,
           const std::vector<Vector3d>& ways,
           double start_scale,
           int num_threads)
{
  RobustFitOptions fit;
  fit.start_scale = start_scale;
  fit.max_steps = max_fit_steps;
  fit.tolerance = 0.1 * scorer.noise();
  std::vector<RobustFit> ends(ways.size());
  forEachPiece(ways.size(), num_threads, [&](std::size_t i) {
    ends[i] = fitRobustly(scorer, prior, Eigen::Translation3d(ways[i]) * from, fit);
  });
  return ends;
}

} // namespace

std::vector<RobustFit>
endsOnParallelFaces(const SurfaceScorer& scorer,
                    const SurfaceScorer& subset,
                    const HeldPrior& prior,
                    const RobustFit& from,
                    int num_threads)
{
  const SurfaceScorer looked_at = scorer.ofFirst(num_points_looked_at);
  const FaceFinder finder(looked_at, maxLength(scorer, prior, from.pose));
  std::vector<RobustFit> ends;
  std::vector<Vector3d> ways;
  RobustFit best = from;
  bool is_better = true;
  for (int round = 0; round < max_rounds && is_better; ++round) {
    addToKnown(finder.find(best.pose), ways);
    is_better = false;
    for (RobustFit& end :
         followHops(subset, prior, best.pose, ways, 0.0, num_threads)) {
      ends.push_back(std::move(end));
      if (ends.back().cost < best.cost) {
        best = ends.back();
        is_better = true;
      }
    }
  }
  ends.erase(std::remove_if(ends.begin(),
                            ends.end(),
                            [&](const RobustFit& end) {
                              return end.cost > max_relative_cost * best.cost;
                            }),
             ends.end());
  return ends;
}

std::vector<RobustFit>
endsAtRepeats(const SurfaceScorer& subset,
              const HeldPrior& prior,
              const RobustFit& from,
              const std::vector<Vector3d>& axes,
              int num_threads)
{
  const double step = maxLength(subset, prior, from.pose) / num_slides;
  std::vector<RobustFit> ends;
  for (const Vector3d& axis : axes) {
    const std::vector<Vector3d> ways =
        repeatsAlong(axis, step, subset, from, num_threads);
    for (RobustFit& end :
         followHops(subset, prior, from.pose, ways, step / subset.noise(), num_threads))
      if (end.cost < max_relative_cost * from.cost)
        ends.push_back(std::move(end));
  }
  return ends;
}

} // namespace bayesian_icp
