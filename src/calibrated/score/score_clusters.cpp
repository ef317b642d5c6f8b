#include "calibrated/score/score_clusters.h"

#include "algebra/decompositions.h"
#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/** Seed of the partitions: they belong to the method, not to the run. */
constexpr std::uint64_t partition_seed = 1;

/** Degrees of freedom that six parameters cost: six were fitted, and the inverse of an
 * estimated 6x6 covariance is too large by nu / (nu - 7) on average. */
constexpr double lost_degrees_of_freedom = 13.0;

/** Shells, and what remains of their kappa after its noise: the 99 % quantile of
 * chi-square with six degrees of freedom per shell, over its mean, is 1.43. */
constexpr int num_shells = 12;
constexpr double shells_to_clusters = 1.0 / 1.43;

/** Upper limit of one cluster's share of the information. */
constexpr double max_share = 0.9;

/** Which group each point belongs to. */
struct Groups {
  std::vector<Index> of_point;
  Index count = 0;
};

/** Shells of equal numbers of points about the origin of the source's frame, where its
 * sensor usually is: a ring of a LiDAR has an error of its own, all around the sensor,
 * that no cluster of neighbours contains. About another place they are groups like any
 * other. */
Groups
shellsOf(const Matrix3Xd& positions, Index count)
{
  const Eigen::VectorXd distances = positions.colwise().squaredNorm();
  std::vector<Index> order(static_cast<std::size_t>(positions.cols()));
  std::iota(order.begin(), order.end(), Index(0));
  std::sort(order.begin(), order.end(), [&distances](Index a, Index b) {
    return distances[a] < distances[b] || (distances[a] == distances[b] && a < b);
  });
  Groups shells;
  shells.count = count;
  shells.of_point.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    shells.of_point[static_cast<std::size_t>(order[i])] =
        static_cast<Index>(i) * count / positions.cols();
  return shells;
}

/** Makes groups by one randomised kd-split. */
class KdSplit {
public:
  KdSplit(const Matrix3Xd& positions, Index max_points, Random& random)
  : rotated_(randomRotation(random) * positions)
  , max_points_(max_points)
  , random_(random)
  , order_(static_cast<std::size_t>(positions.cols()))
  , keys_(order_.size())
  {
    leaves_.of_point.resize(order_.size());
    std::iota(order_.begin(), order_.end(), Index(0));
    split(0, positions.cols());
  }

  const Groups&
  leaves() const
  {
    return leaves_;
  }

private:
  static Eigen::Matrix3d
  randomRotation(Random& random)
  {
    const double w = random.normal(), x = random.normal(), y = random.normal(),
                 z = random.normal();
    return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  }

  void
  split(Index begin, Index end)
  {
    if (end - begin <= max_points_) {
      for (Index i = begin; i < end; ++i)
        leaves_
            .of_point[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])] =
            leaves_.count;
      ++leaves_.count;
      return;
    }
    const Index axis = widestAxis(begin, end);
    const double part = 0.4 + 0.2 * random_.uniform();
    const Index middle =
        begin + std::max<Index>(1, static_cast<Index>(part * double(end - begin)));
    const auto size = static_cast<std::size_t>(end - begin);
    for (std::size_t i = 0; i < size; ++i) {
      const Index point = order_[static_cast<std::size_t>(begin) + i];
      keys_[i] = {rotated_(axis, point), point};
    }
    std::nth_element(
        keys_.begin(), keys_.begin() + (middle - begin), keys_.begin() + (end - begin));
    for (std::size_t i = 0; i < size; ++i)
      order_[static_cast<std::size_t>(begin) + i] = keys_[i].second;
    split(begin, middle);
    split(middle, end);
  }

  Index
  widestAxis(Index begin, Index end) const
  {
    Vector3d low = rotated_.col(order_[static_cast<std::size_t>(begin)]), high = low;
    for (Index i = begin; i < end; ++i) {
      const auto point = rotated_.col(order_[static_cast<std::size_t>(i)]);
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    Index axis = 0;
    (high - low).maxCoeff(&axis);
    return axis;
  }

  Matrix3Xd rotated_;
  Index max_points_;
  Random& random_;
  std::vector<Index> order_;
  /** Coordinate and index of the points that are being split. */
  std::vector<std::pair<double, Index>> keys_;
  Groups leaves_;
};

/** Sums of the groups' scores, less their share of the total. */
Matrix6Xd
groupSums(const Matrix6Xd& scores, const Groups& groups)
{
  Matrix6Xd sums = Matrix6Xd::Zero(6, groups.count);
  Eigen::RowVectorXd counts = Eigen::RowVectorXd::Zero(groups.count);
  for (Index i = 0; i < scores.cols(); ++i) {
    const Index group = groups.of_point[static_cast<std::size_t>(i)];
    sums.col(group) += scores.col(i);
    counts[group] += 1.0;
  }
  const Vector6d mean = scores.rowwise().mean();
  return sums - mean * counts;
}

/** Give back to the groups what fitting six parameters took from them, so that their
 * outer products are right on average for independent points: CR2 of Bell and McCaffrey
 * (2002), (I - H_b)^-1/2 s_b, H_b being the group's share of the information. A
 * direction that a few groups hold loses nearly all of their scores.
 * \param[in] whitened L^-1 j of each point, working information L L^T
 * \param[in,out] sums L^-1 s_b of each group */
void
undoFit(const Matrix6Xd& whitened, const Groups& groups, Matrix6Xd& sums)
{
  std::vector<Matrix6d> shares(static_cast<std::size_t>(groups.count),
                               Matrix6d::Zero());
  for (Index i = 0; i < whitened.cols(); ++i)
    shares[static_cast<std::size_t>(groups.of_point[static_cast<std::size_t>(i)])]
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(whitened.col(i));
  for (Index b = 0; b < sums.cols(); ++b) {
    const Eigen::SelfAdjointEigenSolver<Matrix6d> share(
        shares[static_cast<std::size_t>(b)]);
    const Vector6d left = 1.0 - share.eigenvalues().array().min(max_share);
    sums.col(b) = share.eigenvectors() * left.cwiseSqrt().cwiseInverse().asDiagonal() *
                  share.eigenvectors().transpose() * sums.col(b);
  }
}

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
  const Index max_points =
      std::max<Index>(2, num_points / std::max(1, options.num_clusters));
  const bool is_fitted = points.jacobians.cols() == num_points;
  Matrix6d L = Matrix6d::Identity();
  Matrix6Xd whitened;
  if (is_fitted) {
    L = working_information.llt().matrixL();
    whitened = L.triangularView<Eigen::Lower>().solve(points.jacobians);
  }
  Random random(partition_seed, options.stream);
  Matrix6d sum = Matrix6d::Zero();
  for (int k = 0; k < options.num_partitions; ++k) {
    const Groups groups = options.are_shells
                              ? shellsOf(points.positions, options.num_clusters)
                              : KdSplit(points.positions, max_points, random).leaves();
    Matrix6Xd sums =
        L.triangularView<Eigen::Lower>().solve(groupSums(points.scores, groups));
    const auto num_groups = static_cast<double>(groups.count);
    if (is_fitted)
      undoFit(whitened, groups, sums);
    else
      sums *= std::sqrt(num_groups / std::max(1.0, num_groups - 1.0));
    sum += sums * sums.transpose();
  }
  return L * sum * L.transpose() / options.num_partitions;
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
  constexpr int num_sizes = 5, shells = 4;
  constexpr int num_clusters[num_sizes] = {12, 24, 48, 96, num_shells};
  constexpr int num_partitions[num_sizes] = {16, 12, 8, 8, 1};
  Matrix6d clustered[num_sizes];
  forEachPiece(num_sizes, num_threads, [&](std::ptrdiff_t i) {
    ClusterOptions options;
    options.num_clusters = num_clusters[i];
    options.num_partitions = num_partitions[i];
    options.stream = static_cast<std::uint64_t>(num_clusters[i]);
    options.are_shells = i == shells;
    clustered[i] = clusteredCovariance(points, working_information, options);
  });
  const double kappa_12 = kappa(clustered[0]), kappa_24 = kappa(clustered[1]);
  const double kappa_96 = kappa(clustered[3]);
  const Matrix6d& J_48 = clustered[2];
  ScoreCovariance result;
  result.kappa_48 = kappa(J_48);
  // Points at the border of a square cluster of side a miss a part of their neighbours
  // that shrinks as 1 / a on each axis: sqrt(kappa) = sqrt(kappa_inf) (1 - b / a), and
  // a is twice as large for 12 clusters as for 48, and for 24 as for 96.
  const double root = std::sqrt(kappa_12) + std::sqrt(kappa_24) -
                      0.5 * (std::sqrt(result.kappa_48) + std::sqrt(kappa_96));
  result.kappa_inf = std::max({1.0, kappa_24, root * root});
  result.kappa =
      std::max(result.kappa_inf, shells_to_clusters * kappa(clustered[shells]));
  // Number of independent points to which the correlated ones are equivalent.
  const double nu = static_cast<double>(points.scores.cols()) / result.kappa;
  const double correction = nu / std::max(1.0, nu - lost_degrees_of_freedom);
  result.covariance =
      0.5 * correction * result.kappa * (J_48 / result.kappa_48 + independent);
  return result;
}

} // namespace bayesian_icp
