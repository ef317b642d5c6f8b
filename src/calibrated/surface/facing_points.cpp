#include "calibrated/surface/facing_points.h"

#include "algebra/decompositions.h"
#include "geometry/principal_axes.h"

#include <bayesian_icp/kd_tree.h>
#include <bayesian_icp/pose.h>

#include <algorithm>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/** A motion is rare if the mean squared cosine between it and the normals of the
 * patches, weighted by the square of the motion, is below this. Measured: at most 0.018
 * along tunnels, corridors and roads with little that faces the motion, and from 0.028
 * in thirteen real sequences, the least in a corridor with doors. */
constexpr double max_rare = 0.02;
/** Patches face a motion if the squared cosine between it and their normal is above
 * min_facing. More than max_share of the patches need no help. */
constexpr double min_facing = 0.5, max_share = 0.05;
/** Points are on a patch up to this fraction of its radius from its centre. */
constexpr double part_of_radius = 0.5;
/** Fewer usable patches say nothing about motions. */
constexpr std::size_t min_patches = 10;

/** A patch about the centroid of all: where, and which way it faces. */
struct Facet {
  const SurfacePatch& patch;
  Vector3d arm, normal;

  /** Velocity under a twist about the centroid. */
  Vector3d
  motionBy(const Vector6d& twist) const
  {
    return twist.head<3>() + twist.tail<3>().cross(arm);
  }
};

std::vector<Facet>
facetsOf(const SurfaceModel& model)
{
  std::vector<Facet> facets;
  Vector3d centroid = Vector3d::Zero();
  for (const SurfacePatch& patch : model.patches())
    if (patch.isUsable()) {
      facets.push_back({patch, patch.centre, patch.axes.col(2)});
      centroid += patch.centre;
    }
  centroid /= static_cast<double>(facets.size());
  for (Facet& facet : facets)
    facet.arm -= centroid;
  return facets;
}

/** Axes that are uncorrelated in the metric of mean squared motions; the variances are
 * the mean squared cosines between motions and normals. */
PrincipalAxes
motionsHeldBy(const std::vector<Facet>& facets)
{
  Matrix6d held = Matrix6d::Zero(), metric = Matrix6d::Zero();
  for (const Facet& facet : facets) {
    Vector6d row;
    row << facet.normal, facet.arm.cross(facet.normal);
    held += row * row.transpose();
    metric.topLeftCorner<3, 3>() += Eigen::Matrix3d::Identity();
    metric.bottomRightCorner<3, 3>() +=
        facet.arm.squaredNorm() * Eigen::Matrix3d::Identity() -
        facet.arm * facet.arm.transpose();
  }
  const Matrix6d inverse = metric.inverse();
  return PrincipalAxes(inverse * held * inverse, metric);
}

/** The facets that face a motion and are clear. */
std::vector<const SurfacePatch*>
patchesFacing(const Vector6d& twist, const std::vector<Facet>& facets)
{
  std::vector<const SurfacePatch*> facing;
  for (const Facet& facet : facets) {
    const Vector3d motion = facet.motionBy(twist);
    const double across = motion.dot(facet.normal);
    if (facet.patch.has_clear_normal &&
        across * across > min_facing * motion.squaredNorm())
      facing.push_back(&facet.patch);
  }
  return facing;
}

} // namespace

std::vector<Index>
pointsFacingRareMotions(const Matrix3Xd& points,
                        const std::vector<Index>& columns,
                        const SurfaceModel& model)
{
  const std::vector<Facet> facets = facetsOf(model);
  if (facets.size() < min_patches)
    return {};
  const PrincipalAxes motions = motionsHeldBy(facets);
  std::vector<const SurfacePatch*> patches;
  for (int k = 0; k < 6 && motions.variances[k] < max_rare; ++k) {
    const auto facing = patchesFacing(motions.axes.col(k), facets);
    if (static_cast<double>(facing.size()) <
        max_share * static_cast<double>(facets.size()))
      patches.insert(patches.end(), facing.begin(), facing.end());
  }
  if (patches.empty())
    return {};
  Eigen::Matrix3Xf centres(3, static_cast<Index>(patches.size()));
  double largest = 0.0;
  for (std::size_t j = 0; j < patches.size(); ++j) {
    centres.col(static_cast<Index>(j)) = patches[j]->centre.cast<float>();
    largest = std::max(largest, part_of_radius * patches[j]->radius);
  }
  const KdTree tree(std::move(centres), 1);
  std::vector<Index> found;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Vector3d place = points.col(columns[i]) - model.origin();
    const auto nearest =
        tree.nearest(place.cast<float>(), static_cast<float>(largest * largest));
    if (nearest.index == KdTree::none)
      continue;
    const double radius = part_of_radius * patches[nearest.index]->radius;
    if (double(nearest.squared_distance) < radius * radius)
      found.push_back(static_cast<Index>(i));
  }
  return found;
}

} // namespace bayesian_icp
