#include "search/target.h"

#include "search/finite_columns.h"
#include "search/squared_gate.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <limits>
#include <utility>

namespace bayesian_icp {

namespace {

using IndexIterator = std::vector<Eigen::Index>::iterator;

constexpr std::ptrdiff_t patch_size = 16;

/** Principal axes and variances of points, ascending [m^2]. */
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>
shapeOf(const Eigen::Matrix3Xf& points, IndexIterator first, IndexIterator last)
{
  const double size = static_cast<double>(last - first);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (auto i = first; i != last; ++i)
    mean += points.col(*i).cast<double>() / size;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (auto i = first; i != last; ++i) {
    const Eigen::Vector3d d = points.col(*i).cast<double>() - mean;
    scatter += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scatter / size);
  return solver;
}

/** Halves the points at the median of their longest side until they are a patch, which
 * visit(its shape, index of a point) is told of for each point. */
template <typename Visitor>
void
splitIntoPatches(const Eigen::Matrix3Xf& points,
                 IndexIterator first,
                 IndexIterator last,
                 const Visitor& visit)
{
  if (last - first <= patch_size) {
    if (last - first < 3)
      return;
    const auto shape = shapeOf(points, first, last);
    for (auto i = first; i != last; ++i)
      visit(shape, *i);
    return;
  }
  Eigen::Vector3f low = points.col(*first), high = low;
  for (auto i = first; i != last; ++i) {
    low = low.cwiseMin(points.col(*i));
    high = high.cwiseMax(points.col(*i));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [&](Eigen::Index a, Eigen::Index b) {
    return points(axis, a) < points(axis, b);
  });
  splitIntoPatches(points, first, middle, visit);
  splitIntoPatches(points, middle, last, visit);
}

template <typename Visitor>
void
forEachPatchPoint(const Eigen::Matrix3Xf& points, const Visitor& visit)
{
  std::vector<Eigen::Index> finite = finiteColumns(points);
  splitIntoPatches(points, finite.begin(), finite.end(), visit);
}

/** Eigenvalues of C, of those of the covariance, ascending [m^2]. */
Eigen::Vector3d
regularized(const Eigen::Vector3d& variances, CovarianceRegularization regularization)
{
  constexpr double flatness = 1e-3, added = 1e-3 /* [m^2] */, least_share = 1e-6;
  switch (regularization) {
  case CovarianceRegularization::Plane:
    break;
  case CovarianceRegularization::Frobenius: {
    const Eigen::Vector3d sum = variances.array() + added;
    return 0.5 * sum.cwiseInverse().norm() * sum;
  }
  case CovarianceRegularization::None: {
    const double least =
        std::max(least_share * variances[2], std::numeric_limits<double>::min());
    const Eigen::Vector3d raised = variances.cwiseMax(least);
    return 0.5 / raised[0] * raised;
  }
  }
  return Eigen::Vector3d(flatness, 1.0, 1.0) / (2.0 * flatness);
}

} // namespace

TreeTarget::TreeTarget(const KdTree& tree,
                       double max_distance,
                       Eigen::Matrix3Xf normals,
                       std::vector<Eigen::Matrix3d> covariances)
: tree_(tree)
, max_squared_distance_(squaredGate(max_distance))
, normals_(std::move(normals))
, covariances_(std::move(covariances))
{}

void
TreeTarget::match(const Vector6d& /* pose */,
                  const std::vector<std::size_t>& indices,
                  const Eigen::Matrix3Xf& moved,
                  NeighborCache& cache,
                  std::vector<TargetMatch>& matches) const
{
  matches.clear();
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::uint32_t neighbor =
        cache.nearest(tree_,
                      max_squared_distance_,
                      indices[i],
                      moved.col(static_cast<Eigen::Index>(i)));
    if (neighbor == KdTree::none)
      continue;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    if (normals_.cols() > 0)
      normal = normals_.col(neighbor);
    matches.push_back({i,
                       tree_.points().col(neighbor),
                       normal,
                       covariances_.empty() ? nullptr : &covariances_[neighbor]});
  }
}

void
SearchTarget::match(const Vector6d& pose,
                    const std::vector<std::size_t>& indices,
                    const Eigen::Matrix3Xf& moved,
                    NeighborCache& /* cache */,
                    std::vector<TargetMatch>& matches) const
{
  Correspondences pairs;
  search_.find(pose, indices, moved.cast<double>(), pairs);
  matches.clear();
  for (const auto& pair : pairs)
    matches.push_back(
        {pair.source_index, pair.target_point.cast<float>(), Eigen::Vector3f::Zero()});
}

Eigen::Matrix3Xf
patchNormals(const Eigen::Matrix3Xf& points)
{
  Eigen::Matrix3Xf normals = Eigen::Matrix3Xf::Zero(3, points.cols());
  forEachPatchPoint(points, [&](const auto& shape, Eigen::Index i) {
    normals.col(i) = shape.eigenvectors().col(0).template cast<float>();
  });
  return normals;
}

std::vector<Eigen::Matrix3d>
patchCovariances(const Eigen::Matrix3Xf& points,
                 CovarianceRegularization regularization)
{
  std::vector<Eigen::Matrix3d> covariances(static_cast<std::size_t>(points.cols()),
                                           0.5 * Eigen::Matrix3d::Identity());
  forEachPatchPoint(points, [&](const auto& shape, Eigen::Index i) {
    const Eigen::Matrix3d& axes = shape.eigenvectors();
    covariances[static_cast<std::size_t>(i)] =
        axes * regularized(shape.eigenvalues(), regularization).asDiagonal() *
        axes.transpose();
  });
  return covariances;
}

TreeTarget
treeTargetFor(const ResidualOptions& residual, const KdTree& tree)
{
  const Eigen::Matrix3Xf& points = tree.points();
  if (residual.residual == Residual::PointToPlane)
    return TreeTarget(tree, residual.max_distance, patchNormals(points));
  if (residual.residual == Residual::DistributionToDistribution)
    return TreeTarget(tree,
                      residual.max_distance,
                      Eigen::Matrix3Xf(),
                      patchCovariances(points, residual.regularization));
  return TreeTarget(tree, residual.max_distance);
}

} // namespace bayesian_icp
