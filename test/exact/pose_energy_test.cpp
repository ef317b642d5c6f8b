// The energy of preset `exact`: residuals, kernels, gradients, coordinates, targets.
#include "exact/pose_energy.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <utility>

namespace bayesian_icp {
namespace {

/** Points of a wavy surface near (1, 0.5, -0.3). */
Eigen::Matrix3Xd
surface(Random& random, Eigen::Index num_points)
{
  Eigen::Matrix3Xd points = test::randomPoints(random, num_points, {1.0, 0.5, -0.3});
  for (Eigen::Index i = 0; i < num_points; ++i)
    points(2, i) = -0.3 + 0.1 * std::sin(6.0 * points(0, i)) * points(1, i);
  return points;
}

/** A scan of the surface, its source seen from a little off. */
struct Scan {
  Random random{71, 0};
  Eigen::Matrix3Xf target = surface(random, 1500).cast<float>();
  Eigen::Matrix3Xd source = surface(random, 200);
  Vector6d pose{0.02, -0.015, 0.03, 0.04, -0.05, 0.03};
  KdTree tree{target};
};

Prior
somePrior(const Eigen::Vector3d& reference = Eigen::Vector3d::Zero())
{
  return Prior(
      {0.1, -0.1, 0.05, 0.2, -0.1, 0.3}, {0.1, 0.2, 0.3, 0.05, 0.1, 0.2}, reference);
}

/** Point to point, with a prior about \p reference. */
struct PlainEnergy : Scan {
  explicit PlainEnergy(const Eigen::Vector3d& reference = Eigen::Vector3d::Zero())
  : energy(source, target_of_tree, somePrior(reference), 1.0, ResidualOptions())
  {}

  TreeTarget target_of_tree{tree, 1.0};
  PoseEnergy energy;
};

std::vector<ResidualOptions>
allResiduals(double kernel_width, double max_distance)
{
  using Regularization = CovarianceRegularization;
  constexpr auto distribution = Residual::DistributionToDistribution;
  std::vector<ResidualOptions> all;
  for (const auto& [residual, regularization] :
       {std::pair(Residual::PointToPoint, Regularization::Plane),
        std::pair(Residual::PointToPlane, Regularization::Plane),
        std::pair(distribution, Regularization::Plane),
        std::pair(distribution, Regularization::Frobenius),
        std::pair(distribution, Regularization::None)})
    for (const auto kernel :
         {RobustKernel::None, RobustKernel::Huber, RobustKernel::Tukey}) {
      ResidualOptions options;
      options.residual = residual;
      options.regularization = regularization;
      options.kernel = kernel;
      options.kernel_width = kernel_width;
      options.max_distance = max_distance;
      all.push_back(options);
    }
  return all;
}

std::string
nameOf(const ResidualOptions& options)
{
  return std::string(toString(options.residual)) + " " +
         toString(options.regularization) + " " + toString(options.kernel);
}

TEST(Kernels, WeightIsTheDerivativeOverTheResidual)
{
  for (const auto& options : allResiduals(0.03, 1.0))
    for (const double r : {0.001, 0.02, 0.0299, 0.0301, 0.05, 1.0}) {
      const double h = 1e-6;
      const double derivative = (robustEnergy(options, (r + h) * (r + h)) -
                                 robustEnergy(options, (r - h) * (r - h))) /
                                (2.0 * h);
      EXPECT_NEAR(robustWeight(options, r * r) * r, derivative, 1e-7)
          << nameOf(options) << " at " << r;
    }
}

TEST(Kernels, KnownValues)
{
  ResidualOptions options;
  options.kernel_width = 2.0;
  EXPECT_DOUBLE_EQ(robustEnergy(options, 9.0), 4.5);
  options.kernel = RobustKernel::Huber;
  EXPECT_DOUBLE_EQ(robustEnergy(options, 9.0), 2.0 * (3.0 - 1.0));
  options.kernel = RobustKernel::Tukey;
  EXPECT_DOUBLE_EQ(robustEnergy(options, 9.0), 4.0 / 6.0);
  EXPECT_EQ(robustWeight(options, 9.0), 0.0);
}

/** Keeps the matches that were found at one pose: what gradients hold fixed. */
class FixedMatches : public Target {
public:
  FixedMatches(const Target& target, const Vector6d& pose)
  : target_(target)
  , pose_(pose)
  {}

  void
  match(const Vector6d& /* pose */,
        const std::vector<std::size_t>& indices,
        const Eigen::Matrix3Xf& moved,
        NeighborCache& hints,
        std::vector<TargetMatch>& matches) const override
  {
    if (fixed_.empty())
      target_.match(pose_, indices, moved, hints, fixed_);
    matches = fixed_;
  }

  bool
  isThreadSafe() const override
  {
    return false;
  }

private:
  const Target& target_;
  Vector6d pose_;
  mutable std::vector<TargetMatch> fixed_;
};

TEST(Gradients, OfEveryResidualAndKernelAgreeWithFiniteDifferences)
{
  const Scan scan;
  const Prior prior = somePrior({0.3, 0.2, 0.1});
  // Near the identity, and turned by more than a right angle about all axes.
  Vector6d far = scan.pose;
  far.tail<3>() << 1.9, -0.8, 2.6;
  for (auto options : allResiduals(0.03, 0.08))
    for (const Vector6d& pose : {scan.pose, far}) {
      if (pose == far)
        options.kernel_width = options.max_distance = 10.0;
      const TreeTarget target = treeTargetFor(options, scan.tree);
      const FixedMatches fixed(target, pose);
      const PoseEnergy energy(scan.source, fixed, prior, 1000.0, options);
      const Vector6d phi = energy.toPhi(pose);
      EnergyWorkspace workspace = energy.makeWorkspace();
      const BatchTerms terms = energy.batchTerms(
          phi, energy.allPoints(), BatchTerms::Gradient, options, workspace);
      const Vector6d gradient =
          energy.weight() * terms.gradient + energy.priorGradient(phi);
      const Vector6d numerical = test::centralDifferences(
          [&](const Vector6d& p) { return energy.energy(energy.toTheta(p)); },
          phi,
          1e-3);
      // Coordinates are single precision: 1e-7 m of 0.05 m residuals, step 1e-3, and
      // the curvature of the energy over that step.
      const double tolerance = 0.01 * gradient.norm() + 0.01;
      EXPECT_LT((gradient - numerical).norm(), tolerance)
          << nameOf(options) << "\n"
          << gradient.transpose() << "\n"
          << numerical.transpose();
    }
}

TEST(Gradients, OfTheCentredPoseAgreeWithFiniteDifferences)
{
  for (const Eigen::Vector3d& reference :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(1.0, 0.5, -0.3)}) {
    const PlainEnergy scan(reference);
    const PoseEnergy& energy = scan.energy;
    const Vector6d phi = energy.toPhi(scan.pose);
    const Vector6d numerical = test::centralDifferences(
        [&](const Vector6d& p) { return energy.priorEnergy(p); }, phi);
    EXPECT_LT((energy.priorGradient(phi) - numerical).norm(), 1e-6);

    // The Hessian at the mean, by differences of the gradient.
    const Vector6d mean = energy.toPhi(energy.prior().mean());
    Matrix6d hessian;
    for (int k = 0; k < 6; ++k) {
      const Vector6d h = 1e-5 * Vector6d::Unit(k);
      hessian.col(k) =
          (energy.priorGradient(mean + h) - energy.priorGradient(mean - h)) / 2e-5;
    }
    EXPECT_LT((energy.priorPrecision() - hessian).norm(), 1e-6);
  }
}

TEST(CentredPose, IsInvertibleAndMovesTheCentroidByItsTranslation)
{
  const PlainEnergy scan;
  const Vector6d phi = scan.energy.toPhi(scan.pose);
  EXPECT_LT((scan.energy.toTheta(phi) - scan.pose).norm(), 1e-14);
  const Eigen::Vector3d c = scan.source.rowwise().mean();
  const Eigen::Vector3d moved = rotationOf(scan.pose) * c + scan.pose.head<3>();
  EXPECT_LT((moved - c - phi.head<3>()).norm(), 1e-14);
}

TEST(Energy, IsTheSameWithAndWithoutMemoryAndThroughASearch)
{
  const Scan scan;
  ResidualOptions options;
  options.max_distance = 0.05;
  const TreeTarget target(scan.tree, options.max_distance);
  const test::BruteForceSearch search(scan.target.cast<double>(), options.max_distance);
  const SearchTarget through_search(search);
  const Prior prior = somePrior();
  const PoseEnergy energy(scan.source, target, prior, 100.0, options);
  const PoseEnergy reference(scan.source, through_search, prior, 100.0, options);
  auto workspace = energy.makeWorkspace();
  Random random(72, 0);
  for (int i = 0; i < 200; ++i) {
    const double step = i % 10 == 9 ? 0.02 : 0.001;
    const Vector6d pose = scan.pose + step * random.normal6();
    const double value = energy.energy(pose);
    EXPECT_EQ(energy.energy(pose, workspace), value);
    EXPECT_NEAR(reference.energy(pose), value, 1e-5 * std::abs(value));
  }
}

TEST(Energy, FarOutEveryPointCostsTheGate)
{
  const Scan scan;
  ResidualOptions options;
  options.max_distance = 0.05;
  options.kernel_width = 0.03;
  const TreeTarget target(scan.tree, options.max_distance);
  const Prior prior = somePrior();
  Vector6d far = scan.pose;
  far[0] += 50.0;
  for (const auto& [kernel, cost] :
       {std::pair(RobustKernel::None, 0.5 * 0.05 * 0.05),
        std::pair(RobustKernel::Huber, 0.03 * (0.05 - 0.5 * 0.03)),
        std::pair(RobustKernel::Tukey, 0.03 * 0.03 / 6.0)}) {
    options.kernel = kernel;
    const PoseEnergy energy(scan.source, target, prior, 100.0, options);
    EXPECT_NEAR(energy.energy(far) - prior.energy(far), 100.0 * cost, 1e-9)
        << toString(kernel);
  }
}

TEST(BatchTerms, CurvatureIsTheGaussNewtonMatrixAndSecondMomentTheNoise)
{
  const PlainEnergy scan;
  const PoseEnergy& energy = scan.energy;
  const Vector6d phi = energy.toPhi(scan.pose);
  auto workspace = energy.makeWorkspace();
  const std::vector<std::size_t> all = energy.allPoints();
  const auto terms = [&](const Vector6d& p,
                         const std::vector<std::size_t>& batch,
                         BatchTerms::Extras extras) {
    return energy.batchTerms(p, batch, extras, energy.residual(), workspace);
  };
  Matrix6d second_moment = Matrix6d::Zero();
  for (const auto i : all) {
    const Vector6d g = terms(phi, {i}, BatchTerms::Gradient).gradient;
    second_moment += g * g.transpose() / static_cast<double>(all.size());
  }
  EXPECT_LT(
      (terms(phi, all, BatchTerms::SecondMoment).second_moment - second_moment).norm(),
      1e-5 * second_moment.norm());
  // Translations of all points: the point-to-point curvature is the identity there.
  const auto curvature = terms(phi, all, BatchTerms::Curvature);
  EXPECT_LT(
      (curvature.point_curvature.topLeftCorner<3, 3>() - Eigen::Matrix3d::Identity())
          .norm(),
      1e-6);
  EXPECT_NEAR((curvature.plane_curvature.topLeftCorner<3, 3>().trace()), 1.0, 1e-5);
}

/** As many points of the plane with this normal, some metres wide. */
Eigen::Matrix3Xf
plane(Eigen::Index num_points, const Eigen::Vector3f& normal)
{
  Random random(73, 0);
  Eigen::Matrix3Xf points(3, num_points);
  const Eigen::Vector3f u = normal.unitOrthogonal(), v = normal.cross(u);
  for (Eigen::Index i = 0; i < num_points; ++i)
    points.col(i) = static_cast<float>(random.normal()) * u +
                    static_cast<float>(random.normal()) * v;
  return points;
}

TEST(Energy, OfDistributionsIsTheMahalanobisDistanceOfTheNearestPoints)
{
  const Scan scan;
  const Eigen::Vector3d centroid = scan.source.rowwise().mean();
  const Eigen::Matrix3d R = rotationOf(scan.pose);
  for (const auto& options : allResiduals(0.05, 10.0)) {
    if (options.residual != Residual::DistributionToDistribution)
      continue;
    const auto of_target = patchCovariances(scan.target, options.regularization);
    const auto of_source = patchCovariances(
        (scan.source.colwise() - centroid).cast<float>(), options.regularization);
    double sum = 0.0;
    for (Eigen::Index i = 0; i < scan.source.cols(); ++i) {
      const Eigen::Vector3d moved = R * scan.source.col(i) + scan.pose.head<3>();
      const auto nearest = scan.tree.nearest(moved.cast<float>(),
                                             std::numeric_limits<float>::infinity());
      const Eigen::Vector3d d = moved - scan.target.col(nearest.index).cast<double>();
      const Eigen::Matrix3d C =
          of_target[nearest.index] +
          R * of_source[static_cast<std::size_t>(i)] * R.transpose();
      sum += robustEnergy(options, d.dot(C.ldlt().solve(d)));
    }
    const TreeTarget target = treeTargetFor(options, scan.tree);
    const Prior prior = somePrior();
    const PoseEnergy energy(scan.source, target, prior, 1000.0, options);
    const double expected = 1000.0 * sum / static_cast<double>(scan.source.cols());
    EXPECT_NEAR(
        energy.energy(scan.pose) - prior.energy(scan.pose), expected, 1e-4 * expected)
        << nameOf(options);
  }
}

TEST(Energy, OfDistributionsCountsAPlanesDistanceAsPointToPlane)
{
  const Eigen::Vector3f normal = Eigen::Vector3f(1, 2, 3).normalized();
  const KdTree tree(plane(3000, normal));
  const Eigen::Matrix3Xd source = plane(400, normal).cast<double>();
  Vector6d pose = Vector6d::Zero();
  pose.head<3>() = 0.2 * normal.cast<double>();
  ResidualOptions options;
  options.residual = Residual::DistributionToDistribution;
  const TreeTarget target = treeTargetFor(options, tree);
  const Prior prior = somePrior();
  const PoseEnergy energy(source, target, prior, 1.0, options);
  // What the spacing within the plane adds: a thousandth of the square of some 5 cm.
  EXPECT_NEAR(energy.energy(pose) - prior.energy(pose), 0.5 * 0.2 * 0.2, 1e-5);
}

TEST(PatchCovariances, AreRegularisedAsStated)
{
  using Regularization = CovarianceRegularization;
  const Eigen::Vector3f normal = Eigen::Vector3f(1, 2, 3).normalized();
  const auto points = plane(300, normal);
  const auto eigenvaluesOf = [](const Eigen::Matrix3d& C) -> Eigen::Vector3d {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(C).eigenvalues();
  };
  for (const auto& C : patchCovariances(points, Regularization::Plane)) {
    EXPECT_LT((eigenvaluesOf(C) - Eigen::Vector3d(0.5, 500.0, 500.0)).norm(), 1e-9);
    EXPECT_NEAR(normal.cast<double>().dot(C * normal.cast<double>()), 0.5, 1e-3);
  }
  for (const auto& C : patchCovariances(points, Regularization::Frobenius))
    EXPECT_NEAR(C.inverse().norm(), 2.0, 1e-9);
  for (const auto& C : patchCovariances(points, Regularization::None)) {
    const Eigen::Vector3d values = eigenvaluesOf(C);
    EXPECT_NEAR(values[0], 0.5, 1e-6);
    // A plane to within single precision: raised to a millionth of the largest.
    EXPECT_NEAR(values[2], 0.5e6, 1.0);
  }
  // Two points are no patch.
  EXPECT_EQ(patchCovariances(points.leftCols(2), Regularization::Plane)[1],
            Eigen::Matrix3d(0.5 * Eigen::Matrix3d::Identity()));
}

TEST(PatchNormals, OfAPlaneAreItsNormal)
{
  const Eigen::Vector3f normal = Eigen::Vector3f(1, 2, 3).normalized();
  Eigen::Matrix3Xf points = plane(300, normal);
  points(0, 7) = std::numeric_limits<float>::quiet_NaN();
  const Eigen::Matrix3Xf normals = patchNormals(points);
  for (Eigen::Index i = 0; i < 300; ++i)
    EXPECT_NEAR(std::abs(normals.col(i).dot(normal)), i == 7 ? 0.0 : 1.0, 1e-4);
}

} // namespace
} // namespace bayesian_icp
