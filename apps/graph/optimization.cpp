#include "graph/optimization.h"

#include "graph/closed_cycles.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <ceres/autodiff_cost_function.h>
#include <ceres/autodiff_manifold.h>
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
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

/** Position [m] and quaternion x y z w: how Ceres sees a pose. */
using Parameters = std::array<double, 7>;

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

/** log(T_edge^-1 T_0_target^-1 T_0_source), whitened, less what comes of the source's
 * noise. */
struct EdgeError {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
  /** S^-1/2, symmetric. */
  Matrix6d whitening;
  double share;

  /** \param[in] noise of the source, 6 independent numbers with variance 1 */
  template <typename T>
  bool
  operator()(const T* target_pose,
             const T* source_pose,
             const T* noise,
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
    const Eigen::Map<const Eigen::Matrix<T, 6, 1>> shared(noise);
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} =
        (whitening.cast<T>() * error - T(std::sqrt(share)) * shared) /
        T(std::sqrt(1.0 - share));
    return true;
  }
};

/** Of one source: as likely as a standard normal number each. */
struct NoiseError {
  template <typename T>
  bool
  operator()(const T* noise, T* residual) const
  {
    std::copy_n(noise, 6, residual);
    return true;
  }
};

Parameters
parametersOf(const Eigen::Matrix4d& pose)
{
  const Eigen::Isometry3d isometry(pose);
  const Eigen::Quaterniond rotation(isometry.linear());
  Parameters parameters;
  Eigen::Map<Eigen::Vector3d>(parameters.data()) = isometry.translation();
  Eigen::Map<Eigen::Quaterniond>(parameters.data() + 3) = rotation.normalized();
  return parameters;
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
          edge.share};
}

/** Whether edges lead from each vertex to vertex 0. */
void
requireConnected(std::size_t num_poses, const std::vector<GraphEdge>& edges)
{
  std::vector<std::size_t> parents(num_poses);
  for (std::size_t k = 0; k < num_poses; ++k)
    parents[k] = k;
  const auto rootOf = [&](int vertex) {
    if (vertex < 0 || static_cast<std::size_t>(vertex) >= num_poses)
      throw std::invalid_argument("vertex " + std::to_string(vertex) + " has no pose");
    auto root = static_cast<std::size_t>(vertex);
    while (parents[root] != root)
      root = parents[root] = parents[parents[root]];
    return root;
  };
  for (const GraphEdge& edge : edges) {
    const std::size_t a = rootOf(edge.target), b = rootOf(edge.source);
    parents[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t k = 0; k < num_poses; ++k)
    if (rootOf(static_cast<int>(k)) != 0)
      throw std::invalid_argument("no edges join scan " + std::to_string(k) +
                                  " to scan 0");
}

/** Of the part of an edge's error that is not its source's. Where that is \p share of
 * the variance, the error as a whole is larger by 1 / sqrt(1 - share). The problem owns
 * the result. */
ceres::LossFunction*
lossOf(RobustLoss loss, double share)
{
  const double border = border_of_95_percent * std::sqrt(1.0 - share);
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
  , noises_(poses.size())
  , problem_(borrowing())
  {
    for (const Eigen::Matrix4d& pose : poses)
      parameters_.push_back(parametersOf(pose));
    for (std::size_t k = 0; k < poses.size(); ++k) {
      problem_.AddParameterBlock(parameters_[k].data(), 7, &twists_);
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<NoiseError, 6, 6>(new NoiseError),
          nullptr,
          noises_[k].data());
    }
    problem_.SetParameterBlockConstant(parameters_.front().data());
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
    for (const Parameters& parameters : parameters_)
      result.poses.push_back({poseOf(transformOf(parameters)), Matrix6d::Zero()});
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

  void
  addEdge(const GraphEdge& edge)
  {
    const EdgeError error = errorOf(edge);
    const auto source = static_cast<std::size_t>(edge.source);
    double* const target_pose =
        parameters_[static_cast<std::size_t>(edge.target)].data();
    double* const source_pose = parameters_[source].data();
    edges_.push_back({error, target_pose, source_pose});
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EdgeError, 6, 7, 7, 6>(new EdgeError(error)),
        lossOf(loss_, edge.share),
        target_pose,
        source_pose,
        noises_[source].data());
  }

  /** Whatever part of the error is the source's. */
  static double
  squaredErrorOf(const PlacedEdge& edge)
  {
    const std::array<double, 6> no_noise{};
    Vector6d residual;
    edge.error(edge.target, edge.source, no_noise.data(), residual.data());
    return (1.0 - edge.error.share) * residual.squaredNorm();
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
    for (std::size_t k = 1; k < parameters_.size(); ++k)
      blocks.emplace_back(parameters_[k].data(), parameters_[k].data());
    ceres::Covariance covariance({});
    if (!blocks.empty() && !covariance.Compute(blocks, &problem_)) {
      result.complaint = "the edges leave a motion of a pose free";
      return;
    }
    for (std::size_t k = 1; k < parameters_.size(); ++k) {
      // Row by row; symmetric, so that the order is of no importance.
      const double* const block = parameters_[k].data();
      covariance.GetCovarianceBlockInTangentSpace(
          block, block, result.poses[k].covariance.data());
    }
  }

  ceres::AutoDiffManifold<RightTwists, 7, 6> twists_;
  RobustLoss loss_;
  std::vector<Parameters> parameters_;
  /** Of each scan as a source, in units of the deviations of its edges. */
  std::vector<std::array<double, 6>> noises_;
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
