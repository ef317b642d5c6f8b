#include "calibrated/score/score_clusters.h"

#include "algebra/decompositions.h"
#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;

namespace {

/** Seed of the partitions: they belong to the method, not to the run. */
constexpr std::uint64_t partition_seed = 1;

/** Degrees of freedom that six parameters cost: six were fitted, and the inverse of an
 * estimated 6x6 covariance is too large by nu / (nu - 7) on average. */
constexpr double lost_degrees_of_freedom = 13.0;

/** Number of shells, and the factor that keeps their kappa from exceeding 1 by chance:
 * the 99 % quantile of chi-square with six degrees of freedom per shell, over its mean,
 * is 1.43. */
constexpr int num_shells = 12;
constexpr double shells_to_clusters = 1.0 / 1.43;

/** Upper limit of kappa_inf in units of kappa_12, because the extrapolation of few
 * clusters is noisy. */
constexpr double max_extrapolation = 1.5;

/** Upper limit of one cluster's share of the information. */
constexpr double max_share = 0.9;

/** Which group each point belongs to. */
struct PointGroups {
  std::vector<Index> of_point;
  Index count = 0;
};

/** Shells of equal numbers of points about the origin of the source's frame, where the
 * sensor usually is. A ring of a LiDAR has an error of its own, all around the sensor,
 * that no cluster of neighbours contains whole. If the sensor is elsewhere, the shells
 * are groups like any other. */
PointGroups
shellsOf(const Matrix3Xd& positions, Index count)
{
  const Eigen::VectorXd distances = positions.colwise().squaredNorm();
  std::vector<Index> order(static_cast<std::size_t>(positions.cols()));
  std::iota(order.begin(), order.end(), Index(0));
  std::sort(order.begin(), order.end(), [&distances](Index a, Index b) {
    return distances[a] < distances[b] || (distances[a] == distances[b] && a < b);
  });
  PointGroups shells;
  shells.count = count;
  shells.of_point.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    shells.of_point[static_cast<std::size_t>(order[i])] =
        static_cast<Index>(i) * count / positions.cols();
  return shells;
}

/** Clusters of neighbours, of several sizes: the nodes of one randomised kd-tree. */
class KdSplit {
public:
  /** \param[in] max_points of a cluster of each size, largest first */
  KdSplit(const Matrix3Xd& positions,
          const std::vector<Index>& max_points,
          Random& random)
  : max_points_(max_points)
  , random_(random)
  , places_(static_cast<std::size_t>(positions.cols()))
  , clusters_(max_points.size())
  {
    const Matrix3Xd rotated =
        randomRotation(random) * (positions.colwise() - positions.rowwise().mean());
    for (Index i = 0; i < rotated.cols(); ++i) {
      Place& place = places_[static_cast<std::size_t>(i)];
      Eigen::Map<Eigen::Vector3f>(place.coordinates.data()) =
          rotated.col(i).cast<float>();
      place.point = static_cast<std::uint32_t>(i);
    }
    leaves_.of_point.resize(places_.size());
    split(0, places_.size(), 0);
  }

  /** Groups of points that are in the same cluster of every size. */
  const PointGroups&
  leaves() const
  {
    return leaves_;
  }

  /** Clusters of one size, as groups of leaves. */
  const PointGroups&
  clusters(std::size_t size) const
  {
    return clusters_[size];
  }

private:
  struct Place {
    std::array<float, 3> coordinates;
    std::uint32_t point;
  };

  static Eigen::Matrix3d
  randomRotation(Random& random)
  {
    const double w = random.normal(), x = random.normal(), y = random.normal(),
                 z = random.normal();
    return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  }

  /** \param[in] size of the first clusters that begin here */
  void
  split(std::size_t begin, std::size_t end, std::size_t size)
  {
    for (; size < max_points_.size() &&
           static_cast<Index>(end - begin) <= max_points_[size];
         ++size)
      ++clusters_[size].count;
    if (size == max_points_.size()) {
      addLeaf(begin, end);
      return;
    }
    const std::size_t middle = halve(begin, end, widestAxis(begin, end));
    split(begin, middle, size);
    split(middle, end, size);
  }

  /** Move the points on one side of about the middle of an axis to the front, without
   * branches that depend on a coordinate, which would take most of the time.
   * \return where the other side begins; neither is empty */
  std::size_t
  halve(std::size_t begin, std::size_t end, std::size_t axis)
  {
    const std::size_t count = end - begin;
    std::array<float, 64> sample;
    for (std::size_t i = 0; i < sample.size(); ++i)
      sample[i] = places_[begin + i * count / sample.size()].coordinates[axis];
    const auto pivot =
        sample.begin() + static_cast<std::ptrdiff_t>(double(sample.size()) *
                                                     (0.4 + 0.2 * random_.uniform()));
    std::nth_element(sample.begin(), pivot, sample.end());
    std::size_t middle = begin;
    for (std::size_t i = begin; i < end; ++i) {
      const Place place = places_[i];
      places_[i] = places_[middle];
      places_[middle] = place;
      middle += place.coordinates[axis] < *pivot;
    }
    return middle > begin ? middle : begin + count / 2; // the smallest is not unique
  }

  void
  addLeaf(std::size_t begin, std::size_t end)
  {
    for (std::size_t i = begin; i < end; ++i)
      leaves_.of_point[places_[i].point] = leaves_.count;
    ++leaves_.count;
    for (PointGroups& clusters : clusters_)
      clusters.of_point.push_back(clusters.count - 1);
  }

  std::size_t
  widestAxis(std::size_t begin, std::size_t end) const
  {
    std::array<float, 3> low = places_[begin].coordinates, high = low;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], places_[i].coordinates[axis]);
        high[axis] = std::max(high[axis], places_[i].coordinates[axis]);
      }
    std::size_t widest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (high[axis] - low[axis] > high[widest] - low[widest])
        widest = axis;
    return widest;
  }

  const std::vector<Index>& max_points_;
  Random& random_;
  std::vector<Place> places_;
  PointGroups leaves_;
  std::vector<PointGroups> clusters_;
};

/** Scores in units of the fit: multiplied by L^-1, working information L L^T. */
struct WhitenedScores {
  Matrix6d L = Matrix6d::Identity();
  /** Less their mean. */
  Matrix6Xd scores;
  /** Empty if the pose was not fitted. */
  Matrix6Xd jacobians;

  WhitenedScores(const PointScores& points, const Matrix6d& working_information)
  : scores(points.scores)
  {
    if (scores.cols() == 0)
      return;
    scores.colwise() -= scores.rowwise().mean().eval();
    if (points.jacobians.cols() != scores.cols())
      return;
    L = working_information.llt().matrixL();
    scores = L.triangularView<Eigen::Lower>().solve(scores);
    jacobians = L.triangularView<Eigen::Lower>().solve(points.jacobians);
  }
};

/** Sums over each of several groups of points. */
struct GroupSums {
  Matrix6Xd scores;
  /** Of the information; empty if the pose was not fitted. */
  std::vector<Matrix6d> shares;

  GroupSums(Index num_groups, bool is_fitted)
  : scores(Matrix6Xd::Zero(6, num_groups))
  , shares(is_fitted ? static_cast<std::size_t>(num_groups) : 0, Matrix6d::Zero())
  {}

  GroupSums(const WhitenedScores& points, const PointGroups& groups)
  : GroupSums(groups.count, points.jacobians.cols() > 0)
  {
    for (std::size_t i = 0; i < groups.of_point.size(); ++i) {
      const auto column = static_cast<Index>(i), group = groups.of_point[i];
      scores.col(group) += points.scores.col(column);
      if (!shares.empty()) {
        const Vector6d jacobian = points.jacobians.col(column);
        shares[static_cast<std::size_t>(group)] += jacobian * jacobian.transpose();
      }
    }
  }

  /** \param[in] groups of the groups of \p parts */
  GroupSums(const GroupSums& parts, const PointGroups& groups)
  : GroupSums(groups.count, !parts.shares.empty())
  {
    for (std::size_t i = 0; i < groups.of_point.size(); ++i) {
      const Index group = groups.of_point[i];
      scores.col(group) += parts.scores.col(static_cast<Index>(i));
      if (!shares.empty())
        shares[static_cast<std::size_t>(group)] += parts.shares[i];
    }
  }
};

/** (I - H)^-1/2 s; eigenvalues of H are limited to max_share. */
Vector6d
withoutShare(const Matrix6d& H, const Vector6d& s)
{
  // Most groups have a small share: terms of the binomial series, until they vanish.
  constexpr double largest_of_series = 0.6, negligible = 1e-15;
  constexpr int max_terms = 64;
  if (H.norm() < largest_of_series) {
    Vector6d term = s, sum = s;
    for (int k = 1; k <= max_terms &&
                    term.squaredNorm() > negligible * negligible * sum.squaredNorm();
         ++k) {
      term = ((2.0 * k - 1.0) / (2.0 * k) * (H * term)).eval();
      sum += term;
    }
    return sum;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> share(H);
  const Vector6d left = 1.0 - share.eigenvalues().array().min(max_share);
  return share.eigenvectors() * left.cwiseSqrt().cwiseInverse().asDiagonal() *
         share.eigenvectors().transpose() * s;
}

/** Sum of the outer products of the groups' scores.
 *
 * CR2 of Bell and McCaffrey (2002), (I - H_b)^-1/2 s_b, restores what the fit of six
 * parameters took from the groups, so that the sum is right on average for independent
 * points. H_b is the group's share of the information. Where a few groups hold a
 * direction, the fit takes nearly all of their scores. */
Matrix6d
outerProducts(const GroupSums& groups)
{
  Matrix6Xd scores = groups.scores;
  const auto count = static_cast<double>(scores.cols());
  if (groups.shares.empty())
    scores *= std::sqrt(count / std::max(1.0, count - 1.0));
  else
    for (Index b = 0; b < scores.cols(); ++b)
      scores.col(b) =
          withoutShare(groups.shares[static_cast<std::size_t>(b)], scores.col(b));
  return scores * scores.transpose();
}

/** Maximum number of points of a cluster, for about \p num_clusters clusters. */
Index
maxPointsOf(Index num_points, int num_clusters)
{
  return std::max<Index>(2, num_points / std::max(1, num_clusters));
}

/** J of partitions into clusters of several sizes, and into shells. */
class ClusteredCovariances {
public:
  static constexpr std::size_t num_sizes = 4;
  static constexpr int num_clusters[num_sizes] = {12, 24, 48, 96};

  ClusteredCovariances(const PointScores& points,
                       const Matrix6d& working_information,
                       int num_threads)
  : points_(points)
  , whitened_(points, working_information)
  {
    if (points.scores.cols() == 0)
      return;
    std::vector<const TreeKind*> trees;
    for (const TreeKind& kind : tree_kinds)
      trees.insert(trees.end(), kind.num_trees, &kind);
    std::vector<std::array<Matrix6d, num_sizes>> of_trees(trees.size());
    const auto num_trees = static_cast<std::ptrdiff_t>(trees.size());
    // The last piece is the shells.
    forEachPiece(num_trees + 1, num_threads, [&](std::ptrdiff_t piece) {
      const auto tree = static_cast<std::size_t>(piece);
      if (piece < num_trees)
        of_trees[tree] = ofTree(*trees[tree], tree);
      else
        shells_ = outerProducts(
            GroupSums(whitened_, shellsOf(points_.positions, num_shells)));
    });
    for (std::size_t size = 0; size < num_sizes; ++size) {
      double count = 0.0;
      for (std::size_t tree = 0; tree < trees.size(); ++tree)
        if (trees[tree]->has_size[size]) {
          clusters_[size] += of_trees[tree][size];
          count += 1.0;
        }
      clusters_[size] /= count;
    }
  }

  Matrix6d
  ofClusters(std::size_t size) const
  {
    return whitened_.L * clusters_[size] * whitened_.L.transpose();
  }

  Matrix6d
  ofShells() const
  {
    return whitened_.L * shells_ * whitened_.L.transpose();
  }

private:
  struct TreeKind {
    std::size_t num_trees;
    bool has_size[num_sizes];
  };

  /** Larger clusters are fewer, so they are averaged over more trees. kappa_inf has the
   * difference of two sizes, one of which is a quarter of the other. The difference has
   * less noise if both come from the same trees. */
  static constexpr TreeKind tree_kinds[] = {{8, {true, false, true, false}},
                                            {8, {false, true, false, true}},
                                            {8, {true, false, false, false}},
                                            {4, {false, true, false, false}}};

  std::array<Matrix6d, num_sizes>
  ofTree(const TreeKind& kind, std::uint64_t stream) const
  {
    std::vector<std::size_t> sizes;
    std::vector<Index> max_points;
    for (std::size_t size = 0; size < num_sizes; ++size)
      if (kind.has_size[size]) {
        sizes.push_back(size);
        max_points.push_back(maxPointsOf(points_.scores.cols(), num_clusters[size]));
      }
    Random random(partition_seed, stream);
    const KdSplit split(points_.positions, max_points, random);
    const GroupSums leaves(whitened_, split.leaves());
    std::array<Matrix6d, num_sizes> products;
    for (std::size_t k = 0; k < sizes.size(); ++k)
      products[sizes[k]] = outerProducts(GroupSums(leaves, split.clusters(k)));
    return products;
  }

  const PointScores& points_;
  WhitenedScores whitened_;
  Matrix6d shells_ = Matrix6d::Zero();
  std::array<Matrix6d, num_sizes> clusters_{
      {Matrix6d::Zero(), Matrix6d::Zero(), Matrix6d::Zero(), Matrix6d::Zero()}};
};

} // namespace

PointScores
activeScores(const SurfaceScores& scores, const Matrix3Xd& source_points)
{
  PointScores points;
  points.scores.resize(6, scores.num_active);
  points.jacobians.resize(6, scores.num_active);
  points.positions.resize(3, scores.num_active);
  Index next = 0;
  for (Index i = 0; i < source_points.cols(); ++i)
    if (scores.active[static_cast<std::size_t>(i)]) {
      points.scores.col(next) = scores.scores.col(i);
      points.jacobians.col(next) = scores.jacobians.col(i);
      points.positions.col(next) = source_points.col(i);
      ++next;
    }
  return points;
}

Matrix6d
clusteredCovariance(const PointScores& points,
                    const Matrix6d& working_information,
                    const ClusterOptions& options)
{
  const Index num_points = points.scores.cols();
  if (num_points == 0)
    return Matrix6d::Zero();
  const WhitenedScores whitened(points, working_information);
  const std::vector<Index> max_points = {maxPointsOf(num_points, options.num_clusters)};
  Random random(partition_seed, options.stream);
  Matrix6d sum = Matrix6d::Zero();
  for (int k = 0; k < options.num_partitions; ++k)
    sum += outerProducts(GroupSums(
        whitened,
        options.are_shells ? shellsOf(points.positions, options.num_clusters)
                           : KdSplit(points.positions, max_points, random).leaves()));
  return whitened.L * sum * whitened.L.transpose() / options.num_partitions;
}

ScoreCovariance
scoreCovariance(const PointScores& points,
                const Matrix6d& fit_precision,
                int num_threads)
{
  const Matrix6d independent = points.scores * points.scores.transpose();
  const Matrix6d information = points.jacobians * points.jacobians.transpose();
  // In the fit, the prior has the weight that the robust start gives it.
  const Matrix6d working_information = information + 5.0 * fit_precision;
  const Eigen::LDLT<Matrix6d> metric(Matrix6d(
      independent + independent.trace() / information.trace() * fit_precision));
  const double size = metric.solve(independent).trace();
  const auto kappa = [&](const Matrix6d& covariance) {
    return metric.solve(covariance).trace() / size;
  };
  const ClusteredCovariances clustered(points, working_information, num_threads);
  const double kappa_12 = kappa(clustered.ofClusters(0)),
               kappa_24 = kappa(clustered.ofClusters(1)),
               kappa_96 = kappa(clustered.ofClusters(3));
  const Matrix6d J_48 = clustered.ofClusters(2);
  ScoreCovariance result;
  result.kappa_48 = kappa(J_48);
  // A square cluster of side a misses the neighbours of points at its border, on each
  // axis: sqrt(kappa_inf / kappa) = 1 + b / a, and a is twice as large for 12 clusters
  // as for 48, and for 24 as for 96.
  const double root =
      std::max(0.0,
               1.0 / std::sqrt(kappa_12) + 1.0 / std::sqrt(kappa_24) -
                   0.5 / std::sqrt(result.kappa_48) - 0.5 / std::sqrt(kappa_96));
  result.kappa_inf = std::max(
      {1.0, kappa_24, std::min(max_extrapolation * kappa_12, 1.0 / (root * root))});
  result.kappa =
      std::max(result.kappa_inf, shells_to_clusters * kappa(clustered.ofShells()));
  // Number of independent points to which the correlated ones are equivalent.
  const double nu = static_cast<double>(points.scores.cols()) / result.kappa;
  const double correction = nu / std::max(1.0, nu - lost_degrees_of_freedom);
  result.covariance =
      0.5 * correction * result.kappa * (J_48 / result.kappa_48 + independent);
  return result;
}

} // namespace bayesian_icp
