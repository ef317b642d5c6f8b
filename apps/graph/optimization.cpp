#include "graph/optimization.h"

#include <boost/pending/disjoint_sets.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <ceres/autodiff_cost_function.h>
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/product_manifold.h>
#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <array>
#include <cmath>
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

/** c in V(w)^-1 = 1 - [w] / 2 + c [w]^2, the inverse of the left Jacobian of SO(3). */
template <typename T>
T
secondCoefficient(const Eigen::Matrix<T, 3, 1>& w)
{
  using std::sqrt;
  using std::tan;
  const T square = w.squaredNorm();
  if (square < T(1e-2))
    return T(1.0 / 12.0) + square / T(720.0) + square * square / T(30240.0);
  const T half = T(0.5) * sqrt(square);
  return (T(1.0) - half / tan(half)) / square;
}

/** Moves Parameters by steps of the position and half angles about the fixed axes. */
using PoseManifold =
    ceres::ProductManifold<ceres::EuclideanManifold<3>, ceres::EigenQuaternionManifold>;

/** log(T_edge^-1 T_0_target^-1 T_0_source), whitened and divided by the deviation of
 * the edge's own part of it. */
struct EdgeError {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
  /** S^-1/2, symmetric, divided by this deviation. */
  Matrix6d whitening;

  template <typename T>
  bool
  operator()(const T* target_pose, const T* source_pose, T* residual) const
  {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const PoseView<T> target(target_pose), source(source_pose);
    const Eigen::Quaternion<T> into_target = target.rotation.conjugate();
    const Eigen::Quaternion<T> into_edge = rotation.conjugate().cast<T>();
    const Vector3 w = rotationVectorOf<T>(into_edge * (into_target * source.rotation));
    const Vector3 shift =
        into_edge *
        (into_target * (source.position - target.position) - position.cast<T>());
    // V(w)^-1 shift
    const Vector3 turned = w.cross(shift);
    Eigen::Matrix<T, 6, 1> error;
    error << shift - T(0.5) * turned + secondCoefficient<T>(w) * w.cross(turned), w;
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} = whitening.cast<T>() * error;
    return true;
  }
};

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
          solver.operatorInverseSqrt() / std::sqrt(edge.shared.own())};
}

/** EdgeError less what comes of noises that other edges have, too: the edge's own part
 * of the error, divided by its deviation. The parameters are the poses of target and
 * source, the noises of their scans (6 independent numbers with variance 1 each), and
 * the num_common numbers of the noise of all edges, column by column. */
class OwnError : public ceres::SizedCostFunction<6, 7, 7, 6, 6, num_common> {
public:
  explicit OwnError(const GraphEdge& edge) : of_poses_(new EdgeError(errorOf(edge)))
  {
    const SharedNoise& shared = edge.shared;
    const double of_scan = std::sqrt(shared.scan / shared.own());
    of_target_ = of_scan * noiseToSource(edge.T_target_source);
    of_source_ = -of_scan * Matrix6d::Identity();
    const Vector6d direction = directionOf(edge.T_target_source);
    for (int k = 0; k < 6; ++k)
      of_all_.middleCols<6>(6 * k) = -std::sqrt(shared.common / shared.own()) *
                                     direction[k] * Matrix6d::Identity();
  }

  bool
  Evaluate(const double* const* parameters,
           double* residuals,
           double** jacobians) const override
  {
    if (!of_poses_.Evaluate(parameters, residuals, jacobians))
      return false;
    Eigen::Map<Vector6d>{residuals} +=
        of_target_ * Eigen::Map<const Vector6d>(parameters[2]) +
        of_source_ * Eigen::Map<const Vector6d>(parameters[3]) +
        of_all_ * Eigen::Map<const OfAllEdges>(parameters[4]);
    if (jacobians == nullptr)
      return true;
    if (jacobians[2] != nullptr)
      Eigen::Map<RowMajor<6>>{jacobians[2]} = of_target_;
    if (jacobians[3] != nullptr)
      Eigen::Map<RowMajor<6>>{jacobians[3]} = of_source_;
    if (jacobians[4] != nullptr)
      Eigen::Map<RowMajor<num_common>>{jacobians[4]} = of_all_;
    return true;
  }

private:
  using OfAllEdges = Eigen::Matrix<double, num_common, 1>;
  template <int columns>
  using RowMajor = Eigen::Matrix<double, 6, columns, Eigen::RowMajor>;

  ceres::AutoDiffCostFunction<EdgeError, 6, 7, 7> of_poses_;
  /** Derivatives by the noises, which are constant. */
  Matrix6d of_target_, of_source_;
  RowMajor<num_common> of_all_;
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
  : edges_(edges)
  , loss_(loss)
  , num_poses_(poses.size())
  , unknowns_(num_poses_ * size_of_scan + num_common)
  {
    auto* const manifold = new PoseManifold; // problem_ owns it
    for (std::size_t k = 0; k < num_poses_; ++k) {
      Eigen::Map<Parameters>{pose(k)} = parametersOf(poses[k]);
      problem_.AddParameterBlock(pose(k), 7, manifold);
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
    for (const GraphEdge& edge : edges_) {
      const Vector6d twist = twistFrom(edge, result.poses);
      result.squared_errors.push_back(twist.dot(edge.covariance.ldlt().solve(twist)));
    }
    addCovariances(result);
    return result;
  }

private:
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
    const auto target = static_cast<std::size_t>(edge.target);
    const auto source = static_cast<std::size_t>(edge.source);
    problem_.AddResidualBlock(new OwnError(edge),
                              lossOf(loss_, edge.shared),
                              pose(target),
                              pose(source),
                              noise(target),
                              noise(source),
                              commonNoise());
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
    const Vector6d whole_angles(1.0, 1.0, 1.0, 2.0, 2.0, 2.0);
    for (std::size_t k = 1; k < num_poses_; ++k) {
      const double* const block = pose(k);
      Matrix6d own; // Row by row; symmetric, so that the order is of no importance.
      covariance.GetCovarianceBlockInTangentSpace(block, block, own.data());
      Eigen::Matrix<double, 6, num_common, Eigen::RowMajor> motion;
      covariance.GetCovarianceBlockInTangentSpace(block, commonNoise(), motion.data());
      // How far the common noise moves the pose, by its unit.
      motion /= considered_deviation * considered_deviation;
      GaussianPose& found = result.poses[k];
      const Matrix6d to_twists =
          noiseToSource(matrixOf(found.mean)) * whole_angles.asDiagonal();
      found.covariance =
          to_twists * (own + motion * motion.transpose()) * to_twists.transpose();
    }
  }

  const std::vector<GraphEdge>& edges_;
  RobustLoss loss_;
  std::size_t num_poses_;
  /** In one piece, because Ceres sorts them by their addresses, and the order decides
   * about the last bits. */
  std::vector<double> unknowns_;
  ceres::Problem problem_;
};

} // namespace

const char*
toString(RobustLoss loss)
{
  static constexpr std::array<const char*, 3> names = {"none", "huber", "cauchy"};
  const auto index = static_cast<std::size_t>(loss);
  return index < names.size() ? names[index] : "unknown";
}

Vector6d
twistFrom(const GraphEdge& edge, const std::vector<GaussianPose>& poses)
{
  const auto poseOfVertex = [&poses](int vertex) {
    return matrixOf(poses[static_cast<std::size_t>(vertex)].mean);
  };
  return logSE3(edge.T_target_source.inverse() * poseOfVertex(edge.target).inverse() *
                poseOfVertex(edge.source));
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
disagreementsOf(const std::vector<ClosedCycle>& cycles, const OptimizedPoses& optimum)
{
  std::vector<std::size_t> num_open(optimum.squared_errors.size(), 0);
  for (const Suspect& suspect : suspectsOf(cycles))
    num_open[suspect.edge] = suspect.num_cycles;
  std::vector<Disagreement> found;
  for (std::size_t k = 0; k < num_open.size(); ++k)
    if (isContradiction(optimum.squared_errors[k]) || num_open[k] > 0)
      found.push_back({k, optimum.squared_errors[k], num_open[k]});
  return found;
}

} // namespace bayesian_icp::app
