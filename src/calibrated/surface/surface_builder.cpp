// SurfaceModel::build(), and its stages.
#include "calibrated/surface/depth_levels.h"
#include "calibrated/surface/even_choice.h"
#include "calibrated/surface/patch_fit.h"
#include "calibrated/surface/surface_model.h"
#include "sampler/median.h"
#include "threads/for_each_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;

namespace {

/** Largest distance of a point from the surface that it takes over, in units of the
 * donor's noise. */
constexpr double max_takeover_residual = 2.5;
/** Smallest sigma of a patch in units of the median and, for targets without noise, of
 * the spacing. */
constexpr double min_sigma_to_median = 0.3;
constexpr double min_sigma_to_spacing = 1e-4;

/** Largest radius of a neighbourhood, as a fraction of the root mean square distance of
 * the points from their centroid. A plane through two distant scan lines does not
 * describe the ground between them, and a large part of the source would share its
 * errors. A target of few points needs larger neighbourhoods: max_radius_of_few is in
 * units of sqrt(neighbours / points) of that distance. */
constexpr double max_radius_to_extent = 0.25, max_radius_of_few = 4.0;
/** A smaller share of quadrics does not determine the noise of the target. */
constexpr double min_share_of_quadrics = 0.05;

/** Number of neighbourhoods that show whether a cloud is exact, and the share of them
 * that must be exact. Noise leaves none. In depth images whose readings are quantised,
 * up to 0.09 have all points on one level. In CAD models, edges and thin walls leave
 * 0.4 to 0.9. */
constexpr std::size_t num_exact_trials = 200;
constexpr double min_share_of_exact = 0.25;

/** The roughness of a plane in an exact cloud is that of an edge, which moves all
 * points that meet it in the same direction. sigma is this many times as large, so that
 * edges hold only what nothing else holds. */
constexpr double edge_doubt = 4.0;

/** Number of indices that a thread takes at a time. */
constexpr int share_size = 64;

/** work(index, workspace) for every index of \p order; a thread has one workspace.
 * Rethrows the first exception. */
template <typename Workspace, typename Work>
void
forEachIndex(const std::vector<std::uint32_t>& order, int num_threads, const Work& work)
{
  const auto count = static_cast<std::ptrdiff_t>(order.size());
  FirstException failure;
#pragma omp parallel num_threads(num_threads)
  {
    Workspace workspace;
#pragma omp for schedule(dynamic, share_size)
    for (std::ptrdiff_t i = 0; i < count; ++i)
      failure.guard([&] { work(order[static_cast<std::size_t>(i)], workspace); });
  }
  failure.rethrow();
}

bool
isQuadric(const SurfacePatch& patch)
{
  return patch.kind == PatchKind::Quadric;
}

/** Fits a patch to every chosen point of a target, and corrects patches with the help
 * of their neighbours. Call each stage once, in the order below. All stages are
 * parallel and give the same bits for every number of threads. */
class SurfaceBuilder {
public:
  /** \param[in] points 3 x n, finite, relative to the model's origin [m]; must outlive
   *            this object
   * \param[in] plane_normal of fitPatch() */
  SurfaceBuilder(const Matrix3Xf& points,
                 const std::optional<Vector3d>& plane_normal,
                 const SurfaceModelOptions& options,
                 int num_threads)
  : plane_normal_(plane_normal)
  , options_(options)
  , num_threads_(numThreadsFor(num_threads, points.cols() / share_size))
  , points_(points)
  , columns_(evenChoice(points, options.max_patches, ChoiceStream::Patches))
  , patch_of_(static_cast<std::size_t>(points.cols()), KdTree::none)
  , neighbors_(columns_.size())
  , spacings_(columns_.size())
  {
    patches.resize(columns_.size());
    for (std::size_t j = 0; j < columns_.size(); ++j)
      patch_of_[static_cast<std::size_t>(columns_[j])] = static_cast<std::uint32_t>(j);
  }

  /** \param[in] may_be_exact whether to look for signs of a cloud without noise */
  void
  fitPatches(bool may_be_exact)
  {
    const PointNeighbors cloud(points_);
    const auto num_points = static_cast<double>(points_.cols());
    const double max_radius =
        spreadOf(points_) *
        std::max(max_radius_to_extent,
                 max_radius_of_few * std::sqrt(options_.num_neighbors / num_points));
    if (may_be_exact && !plane_normal_)
      adaptToExactCloud(cloud, max_radius);
    if (spread_)
      return;
    const auto fitAt = [&](std::uint32_t point, PatchFitWorkspace& workspace) {
      const std::uint32_t patch = patch_of_[point];
      if (patch == KdTree::none)
        return;
      patches[patch] = fitPatch(cloud,
                                points_.col(point),
                                plane_normal_ ? &*plane_normal_ : nullptr,
                                max_radius,
                                options_,
                                workspace,
                                spacings_[patch]);
      noteNeighbors(workspace.nearest.indices, neighbors_[patch]);
    };
    forEachIndex<PatchFitWorkspace>(cloud.alongTree(), num_threads_, fitAt);
    completeNeighbors();
  }

  /** Pool the noise of every quadric over the quadrics around it. */
  void
  poolNoise()
  {
    std::vector<double> noise(patches.size());
    const auto count = static_cast<std::ptrdiff_t>(patches.size());
#pragma omp parallel for num_threads(num_threads_) schedule(static)
    for (std::ptrdiff_t j = 0; j < count; ++j) {
      const auto patch = static_cast<std::size_t>(j);
      noise[patch] = isQuadric(patches[patch])
                         ? pooledNoise(patch)
                         : (is_exact_ ? edge_doubt : 1.0) * patches[patch].sigma;
    }
    std::vector<double> of_quadrics;
    for (std::size_t j = 0; j < patches.size(); ++j)
      if (isQuadric(patches[j]))
        of_quadrics.push_back(noise[j]);
    const bool are_few = static_cast<double>(of_quadrics.size()) <
                         min_share_of_quadrics * static_cast<double>(noise.size());
    median_sigma = medianOf(are_few ? noise : of_quadrics);
    const double least =
        std::max({min_sigma_to_median * median_sigma,
                  min_sigma_to_spacing * spacing(),
                  static_cast<double>(std::numeric_limits<float>::min())});
    for (std::size_t j = 0; j < patches.size(); ++j)
      patches[j].sigma = std::max(noise[j], least);
    median_sigma = std::max(median_sigma, least);
  }

  /** Let each point without a quadric take over the quadric of a neighbour on which it
   * lies. */
  void
  takeOver()
  {
    std::vector<std::uint32_t> donors(patches.size(), KdTree::none);
    const auto count = static_cast<std::ptrdiff_t>(patches.size());
#pragma omp parallel for num_threads(num_threads_) schedule(dynamic, 1024)
    for (std::ptrdiff_t j = 0; j < count; ++j)
      if (!isQuadric(patches[static_cast<std::size_t>(j)]))
        donors[static_cast<std::size_t>(j)] = donorOf(static_cast<std::size_t>(j));
    // Donors are quadrics, so none of them is overwritten.
    for (std::size_t j = 0; j < patches.size(); ++j)
      if (donors[j] != KdTree::none) {
        const Vector3d centre = patches[j].centre;
        patches[j] = patches[donors[j]];
        patches[j].centre = centre;
      }
  }

  /** The points of the patches, projected to their surfaces. */
  Matrix3Xf
  projectedPoints() const
  {
    Matrix3Xf projected(3, static_cast<Index>(patches.size()));
    for (std::size_t j = 0; j < patches.size(); ++j) {
      const SurfaceOffset offset = offsetFrom(patches[j], patches[j].centre);
      projected.col(static_cast<Index>(j)) =
          (patches[j].centre - offset.distance * offset.normal).cast<float>();
    }
    return projected;
  }

  /** Median distance of a point to its nearest neighbour [m]. */
  double
  spacing() const
  {
    return medianOf(spacings_);
  }

  std::vector<SurfacePatch> patches;
  /** Median of the pooled noise [m]. */
  double median_sigma = 0.0;

  /** The points without their levels, if they have any. */
  const std::optional<Matrix3Xf>&
  spread() const
  {
    return spread_;
  }

private:
  /** Number of patches over which noise is pooled, and among which a point without a
   * quadric looks for one to take over. */
  static constexpr std::size_t num_nearest = 12;

  /** The nearest patches of a patch; the first is the patch itself. */
  struct NearestPatches {
    std::array<std::uint32_t, num_nearest> patches;
    std::uint32_t count = 0;
  };

  /** Find out whether the cloud is exact from the neighbourhoods of a few points. In an
   * exact cloud, a neighbourhood that is thick is at an edge, and does not grow. */
  void
  adaptToExactCloud(const PointNeighbors& cloud, double max_radius)
  {
    SurfaceModelOptions exact = options_;
    exact.min_radius_to_noise = 0.0;
    PatchFitWorkspace workspace;
    double spacing;
    const std::size_t step =
        std::max<std::size_t>(1, columns_.size() / num_exact_trials);
    double num_trials = 0.0;
    std::vector<SurfacePatch> exact_patches;
    for (std::size_t j = 0; j < columns_.size(); j += step, ++num_trials) {
      const SurfacePatch patch = fitPatch(cloud,
                                          points_.col(columns_[j]),
                                          nullptr,
                                          max_radius,
                                          exact,
                                          workspace,
                                          spacing);
      if (isExactQuadric(patch))
        exact_patches.push_back(patch);
    }
    is_exact_ =
        static_cast<double>(exact_patches.size()) > min_share_of_exact * num_trials;
    if (!is_exact_)
      return;
    spread_ = spreadLevels(points_, exact_patches, options_.num_neighbors);
    if (spread_)
      return;
    options_ = exact;
    options_.num_neighbors = options_.num_exact_neighbors;
  }

  /** \param[in] points nearest first */
  void
  noteNeighbors(const std::vector<std::uint32_t>& points, NearestPatches& nearest) const
  {
    for (const std::uint32_t point : points) {
      if (nearest.count == num_nearest)
        return;
      if (patch_of_[point] != KdTree::none)
        nearest.patches[nearest.count++] = patch_of_[point];
    }
  }

  /** Searches where a neighbourhood had too few points with a patch. */
  void
  completeNeighbors()
  {
    const std::size_t wanted = std::min(num_nearest, patches.size());
    const auto hasEnough = [wanted](const NearestPatches& nearest) {
      return nearest.count == wanted;
    };
    if (std::all_of(neighbors_.begin(), neighbors_.end(), hasEnough))
      return;
    const Matrix3Xf centre_points = points_(Eigen::all, columns_);
    const PointNeighbors centres(centre_points);
    const auto searchAt = [&](std::uint32_t patch, NeighborList& nearest) {
      if (hasEnough(neighbors_[patch]))
        return;
      centres.find(centre_points.col(patch), num_nearest, nearest);
      neighbors_[patch].count = static_cast<std::uint32_t>(nearest.indices.size());
      std::copy(nearest.indices.begin(),
                nearest.indices.end(),
                neighbors_[patch].patches.begin());
    };
    forEachIndex<NeighborList>(centres.alongTree(), num_threads_, searchAt);
  }

  /** Root mean square of the noise of quadrics around a patch, or its own. */
  double
  pooledNoise(std::size_t patch) const
  {
    const NearestPatches& nearest = neighbors_[patch];
    double sum = 0.0;
    int used = 0;
    for (std::size_t k = 0; k < nearest.count; ++k) {
      const SurfacePatch& neighbor = patches[nearest.patches[k]];
      if (isQuadric(neighbor)) {
        sum += neighbor.sigma * neighbor.sigma;
        ++used;
      }
    }
    return used > 0 ? std::sqrt(sum / used) : patches[patch].sigma;
  }

  /** The quadric on which a point lies, or KdTree::none. */
  std::uint32_t
  donorOf(std::size_t patch) const
  {
    std::uint32_t best = KdTree::none;
    double best_rank = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < neighbors_[patch].count; ++k) {
      const std::uint32_t index = neighbors_[patch].patches[k];
      const SurfacePatch& donor = patches[index];
      if (!isQuadric(donor))
        continue;
      const SurfaceOffset offset = offsetFrom(donor, patches[patch].centre);
      const double residual = std::abs(offset.distance) / donor.sigma;
      if (residual > max_takeover_residual ||
          offset.in_plane > options_.takeover_radius * donor.radius)
        continue;
      const double rank = offset.in_plane / donor.radius + 0.2 * residual;
      if (rank < best_rank) {
        best_rank = rank;
        best = index;
      }
    }
    return best;
  }

  const std::optional<Vector3d>& plane_normal_;
  SurfaceModelOptions options_;
  int num_threads_;
  const Matrix3Xf& points_;
  /** The point of each patch. */
  std::vector<Index> columns_;
  /** The patch of each point, or KdTree::none. */
  std::vector<std::uint32_t> patch_of_;
  std::vector<NearestPatches> neighbors_;
  std::vector<double> spacings_;
  bool is_exact_ = false;
  std::optional<Matrix3Xf> spread_;
};

} // namespace

void
SurfaceModel::build(const Matrix3Xf& points,
                    const SurfaceModelOptions& options,
                    int num_threads,
                    bool may_be_exact)
{
  SurfaceBuilder builder(points, plane_normal_, options, num_threads);
  builder.fitPatches(may_be_exact);
  if (builder.spread())
    return build(*builder.spread(), options, num_threads, false);
  builder.poolNoise();
  if (options.takeover_radius > 0.0)
    builder.takeOver();
  tree_ = KdTree(builder.projectedPoints(), num_threads);
  median_sigma_ = builder.median_sigma;
  spacing_ = builder.spacing();
  patches_ = std::move(builder.patches);
  std::vector<double> radii;
  for (const SurfacePatch& patch : patches_)
    if (patch.isUsable())
      radii.push_back(patch.radius);
  usable_fraction_ =
      static_cast<double>(radii.size()) / static_cast<double>(patches_.size());
  median_radius_ = medianOf(std::move(radii));
}

} // namespace bayesian_icp
