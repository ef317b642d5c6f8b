#include "graph/optimization.h"

#include "graph/closed_cycles.h"

#include <boost/pending/disjoint_sets.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <ceres/autodiff_cost_function.h>
#include <ceres/autodiff_manifold.h>
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>
#include <system_error>

namespace bayesian_icp::app {

namespace {

/** Square root of the 95 % quantile of chi-square with 6 degrees of freedom. */
constexpr double border_of_95_percent = 3.548462;
constexpr int max_iterations = 100;
/** Relative to the sum of squared errors. */
constexpr double tolerance = 1e-12;
/** Of a noise that counts in the covariances and is not estimated: so small that edges
 * do not move it. */
constexpr double considered_deviation = 1e-4;

/** Position [m] and quaternion x y z w: how Ceres sees a pose. */
using Parameters = Eigen::Matrix<double, 7, 1>;

template <typename T>
struct PoseView {
  explicit PoseView(const T* parameters)
  : position(parameters)
  , rotation(parameters + 3)
  {}
  Eigen::Map<const Eigen::Matrix<T, 3, 1>> position;
  Eigen::Map<const Eigen::Quaternion<T>> rotation;
};

template <typename T>
Eigen::Matrix<T, 3, 1>
rotationVectorOf(const Eigen::Quaternion<T>& rotation)
{
  const T ceres_order[4] = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  Eigen::Matrix<T, 3, 1> vector;
  ceres::QuaternionToAngleAxis(ceres_order, vector.data());
  return vector;
}

/** Twists on the right of poses, to first order: CovarianceConvention::RightSE3. */
struct RightTwists {
  template <typename T>
  bool
  Plus(const T* pose, const T* twist, T* moved) const
  {
    const PoseView<T> from(pose);
    T turn[4];
    ceres::AngleAxisToQuaternion(twist + 3, turn);
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{moved} =
        from.position +
        from.rotation * Eigen::Matrix<T, 3, 1>(twist[0], twist[1], twist[2]);
    Eigen::Map<Eigen::Quaternion<T>>{moved + 3} =
        from.rotation * Eigen::Quaternion<T>(turn[0], turn[1], turn[2], turn[3]);
    return true;
  }

  template <typename T>
  bool
  Minus(const T* moved, const T* pose, T* twist) const
  {
    const PoseView<T> from(pose), to(moved);
    const Eigen::Quaternion<T> back = from.rotation.conjugate();
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{twist} = back * (to.position - from.position);
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{twist + 3} =
        rotationVectorOf<T>(back * to.rotation);
    return true;
  }
};

/** log(T_edge^-1 T_0_target^-1 T_0_source), whitened, less what comes of noises that
 * other edges have, too: the edge's own part of the error, of variance 1. */
struct EdgeError {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
  /** S^-1/2, symmetric. */
  Matrix6d whitening;
  /** noiseToSource() of the edge. */
  Matrix6d to_source;
  /** directionOf() it. */
  Vector6d direction;
  SharedNoise shared;

  /** \param[in] target_noise 6 independent numbers with variance 1
   * \param[in] source_noise as well
   * \param[in] common_noise num_common of all edges, column by column */
  template <typename T>
  bool
  operator()(const T* target_pose,
             const T* source_pose,
             const T* target_noise,
             const T* source_noise,
             const T* common_noise,
             T* residual) const
  {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const PoseView<T> target(target_pose), source(source_pose);
    const Eigen::Quaternion<T> into_target = target.rotation.conjugate();
    const Eigen::Quaternion<T> into_edge = rotation.conjugate().cast<T>();
    const Vector3 w = rotationVectorOf<T>(into_edge * (into_target * source.rotation));
    const Vector3 shift =
        into_edge *
        (into_target * (source.position - target.position) - position.cast<T>());
    // V(w)^-1 shift, V^-1 = 1 - [w] / 2 + [w]^2 / 12 - ...
    const Vector3 turned = w.cross(shift);
    Eigen::Matrix<T, 6, 1> error;
    error << shift - T(0.5) * turned + T(1.0 / 12.0) * w.cross(turned), w;
    const Eigen::Map<const Eigen::Matrix<T, 6, 1>> of_target(target_noise);
    const Eigen::Map<const Eigen::Matrix<T, 6, 1>> of_source(source_noise);
    const Eigen::Map<const Eigen::Matrix<T, 6, 6>> of_all(common_noise);
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} =
        (whitening.cast<T>() * error -
         T(std::sqrt(shared.scan)) * (of_source - to_source.cast<T>() * of_target) -
         T(std::sqrt(shared.common)) * (of_all * direction.cast<T>())) /
        T(std::sqrt(shared.own()));
    return true;
  }
};

Parameters
parametersOf(const Eigen::Matrix4d& pose)
{
  const Eigen::Isometry3d isometry(pose);
  const Eigen::Quaterniond rotation(isometry.linear());
  return (Parameters() << isometry.translation(), rotation.normalized().coeffs())
      .finished();
}

Eigen::Matrix4d
transformOf(const Parameters& parameters)
{
  const PoseView<double> view(parameters.data());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = view.rotation.normalized().toRotationMatrix();
  pose.translation() = view.position;
  return pose.matrix();
}

EdgeError
errorOf(const GraphEdge& edge)
{
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(edge.covariance);
  if (!(solver.eigenvalues()[0] > 0.0))
    throw std::invalid_argument(
        "the covariance of edge " + std::to_string(edge.target) + '-' +
        std::to_string(edge.source) + " is not positive definite");
  const Eigen::Isometry3d pose(edge.T_target_source);
  return {pose.translation(),
          Eigen::Quaterniond(pose.linear()).normalized(),
          solver.operatorInverseSqrt(),
          noiseToSource(edge.T_target_source),
          directionOf(edge.T_target_source),
          edge.shared};
}

/** Whether edges lead from each vertex to vertex 0. */
void
requireConnected(std::size_t num_poses, const std::vector<GraphEdge>& edges)
{
  boost::disjoint_sets_with_storage<> parts(num_poses);
  for (const GraphEdge& edge : edges) {
    for (const int vertex : {edge.target, edge.source})
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= num_poses)
        throw std::invalid_argument("vertex " + std::to_string(vertex) +
                                    " has no pose");
    parts.union_set(static_cast<std::size_t>(edge.target),
                    static_cast<std::size_t>(edge.source));
  }
  for (std::size_t k = 1; k < num_poses; ++k)
    if (parts.find_set(k) != parts.find_set(std::size_t(0)))
      throw std::invalid_argument("no edges join scan " + std::to_string(k) +
                                  " to scan 0");
}

/** Of an edge's own part of its error, in units of its deviation. Of an error of d
 * deviations of S the scans take their shares, and d sqrt(own) / (1 - common) is left.
 * The problem owns the result. */
ceres::LossFunction*
lossOf(RobustLoss loss, const SharedNoise& shared)
{
  const double border =
      border_of_95_percent * std::sqrt(shared.own()) / (1.0 - shared.common);
  if (loss == RobustLoss::Huber)
    return new ceres::HuberLoss(border);
  if (loss == RobustLoss::Cauchy)
    return new ceres::CauchyLoss(border);
  return nullptr;
}

/** The graph as Ceres has it. */
class Solver {
public:
  Solver(const std::vector<Eigen::Matrix4d>& poses,
         const std::vector<GraphEdge>& edges,
         RobustLoss loss)
  : loss_(loss)
  , num_poses_(poses.size())
  , unknowns_(num_poses_ * size_of_scan + num_common)
  , problem_(borrowing())
  {
    for (std::size_t k = 0; k < num_poses_; ++k) {
      Eigen::Map<Parameters>{pose(k)} = parametersOf(poses[k]);
      problem_.AddParameterBlock(pose(k), 7, &twists_);
      addNoise(1.0, 6, noise(k));
    }
    addNoise(considered_deviation, num_common, commonNoise());
    problem_.SetParameterBlockConstant(pose(0));
    for (const GraphEdge& edge : edges)
      addEdge(edge);
  }

  OptimizedPoses
  solve()
  {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = max_iterations;
    options.function_tolerance = tolerance;
    options.parameter_tolerance = tolerance;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    OptimizedPoses result;
    if (summary.termination_type != ceres::CONVERGENCE)
      result.complaint = "the poses have not converged: " + summary.message;
    for (std::size_t k = 0; k < num_poses_; ++k)
      result.poses.push_back(
          {poseOf(transformOf(Parameters(pose(k)))), Matrix6d::Zero()});
    for (const PlacedEdge& edge : edges_)
      result.squared_errors.push_back(squaredErrorOf(edge));
    addCovariances(result);
    return result;
  }

private:
  struct PlacedEdge {
    EdgeError error;
    const double *target, *source;
  };

  /** Unknowns of one scan. */
  static constexpr int size_of_scan = 7 + 6;

  double*
  pose(std::size_t scan)
  {
    return unknowns_.data() + scan * size_of_scan;
  }

  /** In units of the deviations of the scan's edges. */
  double*
  noise(std::size_t scan)
  {
    return pose(scan) + 7;
  }

  /** Held at 0. */
  double*
  commonNoise()
  {
    return pose(num_poses_);
  }

  /** Of numbers that are 0 to a deviation. */
  void
  addNoise(double deviation, int size, double* numbers)
  {
    problem_.AddResidualBlock(
        new ceres::NormalPrior(ceres::Matrix::Identity(size, size) / deviation,
                               ceres::Vector::Zero(size)),
        nullptr,
        numbers);
  }

  void
  addEdge(const GraphEdge& edge)
  {
    const EdgeError error = errorOf(edge);
    const auto target = static_cast<std::size_t>(edge.target);
    const auto source = static_cast<std::size_t>(edge.source);
    edges_.push_back({error, pose(target), pose(source)});
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EdgeError, 6, 7, 7, 6, 6, num_common>(
            new EdgeError(error)),
        lossOf(loss_, edge.shared),
        pose(target),
        pose(source),
        noise(target),
        noise(source),
        commonNoise());
  }

  /** Whatever parts of the error other edges have, too. */
  static double
  squaredErrorOf(const PlacedEdge& edge)
  {
    const std::array<double, num_common> no_noise{};
    Vector6d residual;
    edge.error(edge.target,
               edge.source,
               no_noise.data(),
               no_noise.data(),
               no_noise.data(),
               residual.data());
    return edge.error.shared.own() * residual.squaredNorm();
  }

  static ceres::Problem::Options
  borrowing()
  {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void
  addCovariances(OptimizedPoses& result)
  {
    std::vector<std::pair<const double*, const double*>> blocks;
    for (std::size_t k = 1; k < num_poses_; ++k)
      for (const double* other : {pose(k), commonNoise()})
        blocks.emplace_back(pose(k), other);
    ceres::Covariance covariance({});
    if (!blocks.empty() && !covariance.Compute(blocks, &problem_)) {
      result.complaint = "the edges leave a motion of a pose free";
      return;
    }
    for (std::size_t k = 1; k < num_poses_; ++k) {
      const double* const block = pose(k);
      Matrix6d& sum = result.poses[k].covariance;
      // Row by row; symmetric, so that the order is of no importance.
      covariance.GetCovarianceBlockInTangentSpace(block, block, sum.data());
      Eigen::Matrix<double, 6, num_common, Eigen::RowMajor> motion;
      covariance.GetCovarianceBlockInTangentSpace(block, commonNoise(), motion.data());
      // How far the common noise moves the pose, by its unit.
      motion /= considered_deviation * considered_deviation;
      sum += motion * motion.transpose();
    }
  }

  ceres::AutoDiffManifold<RightTwists, 7, 6> twists_;
  RobustLoss loss_;
  std::size_t num_poses_;
  /** In one piece, because Ceres sorts them by their addresses, and the order decides
   * about the last bits. */
  std::vector<double> unknowns_;
  std::vector<PlacedEdge> edges_;
  ceres::Problem problem_;
};

} // namespace

const char*
toString(RobustLoss loss)
{
  static constexpr std::array<const char*, 3> names = {"none", "huber", "cauchy"};
  return names[static_cast<std::size_t>(loss)];
}

OptimizedPoses
optimizedPoses(const std::vector<Eigen::Matrix4d>& poses,
               const std::vector<GraphEdge>& edges,
               RobustLoss loss)
{
  requireConnected(poses.size(), edges);
  try {
    return Solver(poses, edges, loss).solve();
  }
  catch (const std::system_error&) { // Ceres has no memory for a thread
    throw std::bad_alloc();
  }
}

std::vector<Disagreement>
disagreementsOf(const std::vector<GraphEdge>& edges, const OptimizedPoses& optimum)
{
  std::vector<std::size_t> num_open(edges.size(), 0);
  for (const Suspect& suspect : suspectsOf(closedCycles(edges, edges.size() + 1)))
    num_open[suspect.edge] = suspect.num_cycles;
  std::vector<Disagreement> found;
  for (std::size_t k = 0; k < edges.size(); ++k)
    if (isContradiction(optimum.squared_errors[k]) || num_open[k] > 0)
      found.push_back({k, optimum.squared_errors[k], num_open[k]});
  return found;
}

} // namespace bayesian_icp::app
