#include "search/target.h"

#include "search/finite_columns.h"
#include "search/squared_gate.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <utility>

namespace bayesian_icp {

namespace {

using IndexIterator = std::vector<Eigen::Index>::iterator;

constexpr std::ptrdiff_t patch_size = 16;

void
setPatchNormal(const Eigen::Matrix3Xf& points,
               IndexIterator first,
               IndexIterator last,
               Eigen::Matrix3Xf& normals)
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
  solver.computeDirect(scatter);
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  for (auto i = first; i != last; ++i)
    normals.col(*i) = normal;
}

/** Halves the points at the median of their longest side until they are a patch. */
void
splitIntoPatches(const Eigen::Matrix3Xf& points,
                 IndexIterator first,
                 IndexIterator last,
                 Eigen::Matrix3Xf& normals)
{
  if (last - first <= patch_size) {
    if (last - first >= 3)
      setPatchNormal(points, first, last, normals);
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
  splitIntoPatches(points, first, middle, normals);
  splitIntoPatches(points, middle, last, normals);
}

} // namespace

Target::~Target() = default;

TreeTarget::TreeTarget(const KdTree& tree,
                       double max_distance,
                       Eigen::Matrix3Xf normals)
: tree_(tree)
, max_squared_distance_(squaredGate(max_distance))
, normals_(std::move(normals))
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
    matches.push_back({i, tree_.points().col(neighbor), normal});
  }
}

SearchTarget::SearchTarget(const CorrespondenceSearch& search) : search_(search) {}

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

bool
SearchTarget::isThreadSafe() const
{
  return search_.isThreadSafe();
}

Eigen::Matrix3Xf
patchNormals(const Eigen::Matrix3Xf& points)
{
  Eigen::Matrix3Xf normals = Eigen::Matrix3Xf::Zero(3, points.cols());
  std::vector<Eigen::Index> finite = finiteColumns(points);
  splitIntoPatches(points, finite.begin(), finite.end(), normals);
  return normals;
}

} // namespace bayesian_icp
