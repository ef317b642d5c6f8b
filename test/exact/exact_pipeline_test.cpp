// Preset `exact` from end to end, against Metropolis on the same energy.
#include "exact/pose_energy.h"
#include "support/test_support.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/pose.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>

namespace bayesian_icp {
namespace {

/** A wavy surface scanned twice, with 3 mm of noise. */
struct Scans {
  Eigen::Matrix3Xd source;
  KdTree target;
  Vector6d truth;

  explicit Scans(Eigen::Index num_source = 300)
  : source(surface(91, num_source))
  , target(movedSurface())
  , truth(pose())
  {}

  static Vector6d
  pose()
  {
    Vector6d pose;
    pose << 0.01, -0.02, 0.015, 0.02, -0.03, 0.025;
    return pose;
  }

  static Eigen::Matrix3Xd
  surface(std::uint64_t seed, Eigen::Index num_points)
  {
    Random random(seed, 0);
    Eigen::Matrix3Xd points = test::randomPoints(random, num_points);
    for (Eigen::Index i = 0; i < num_points; ++i)
      points(2, i) = 0.1 * std::sin(9.0 * points(0, i)) * std::cos(8.0 * points(1, i)) +
                     0.003 * random.normal();
    return points;
  }

  static Eigen::Matrix3Xf
  movedSurface()
  {
    Eigen::Matrix3Xd moved;
    movePoints(pose(), surface(92, 6000), moved);
    return moved.cast<float>();
  }
};

Options
exactOptions()
{
  Options options;
  options.preset = Preset::Exact;
  options.exact.scale.effective_points = 100.0;
  options.exact.scale.measurement_sigma = 0.01;
  Vector6d spread;
  spread << 0.02, 0.02, 0.02, 0.05, 0.05, 0.05;
  options.exact.initial_spread = spread;
  return options;
}

struct Moments {
  Vector6d mean;
  Matrix6d covariance;
};

Moments
momentsOf(const PoseMatrix& draws)
{
  const Vector6d mean = meanPose(draws);
  return {mean, covarianceAbout(mean, draws, CovarianceConvention::Parameters)};
}

/** KL divergence of Gaussians, of \p b from \p a. */
double
divergence(const Moments& a, const Moments& b)
{
  const Eigen::LLT<Matrix6d> factor(b.covariance);
  const Vector6d d = a.mean - b.mean;
  return 0.5 * (factor.solve(a.covariance).trace() + d.dot(factor.solve(d)) - 6.0 +
                std::log(b.covariance.determinant() / a.covariance.determinant()));
}

/** Random-walk Metropolis on the full energy: four chains in one, shape from \p guide,
 * which only decides how fast it is. */
PoseMatrix
randomWalk(const PoseEnergy& energy, const Moments& guide, int num_draws)
{
  const Matrix6d L = Eigen::LLT<Matrix6d>(guide.covariance).matrixL();
  Random random(93, 0);
  auto workspace = energy.makeWorkspace();
  Vector6d pose = guide.mean;
  double value = energy.energy(pose, workspace);
  PoseMatrix draws(num_draws, 6);
  for (int i = -500; i < num_draws; ++i) {
    for (int step = 0; step < 4; ++step) {
      const Vector6d proposal = pose + 0.95 * (L * random.normal6());
      const double proposed = energy.energy(proposal, workspace);
      if (std::log(1.0 - random.uniform()) < value - proposed) {
        pose = proposal;
        value = proposed;
      }
    }
    if (i >= 0)
      draws.row(i) = pose.transpose();
  }
  return draws;
}

TEST(Exact, AgreesWithMetropolisOnTheSameEnergy)
{
  const Scans scans;
  for (const auto& [residual, steps] :
       {std::pair(Residual::PointToPoint, ExactSteps::Langevin),
        std::pair(Residual::PointToPoint, ExactSteps::Metropolis),
        std::pair(Residual::DistributionToDistribution, ExactSteps::Metropolis)}) {
    Options options = exactOptions();
    options.exact.residual.residual = residual;
    options.exact.steps = steps;
    const auto estimate =
        estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
    ASSERT_EQ(estimate.summary.status, Status::Ok) << estimate.summary.message;
    EXPECT_EQ(estimate.samples.rows(), 2000);
    for (const auto& coordinate : estimate.summary.coordinates)
      EXPECT_GT(std::min(coordinate.bulk_ess, coordinate.tail_ess), 900.0);

    const TreeTarget target = treeTargetFor(options.exact.residual, scans.target);
    const PoseEnergy energy(scans.source,
                            target,
                            Prior(Vector6d::Zero(), options.prior.variance),
                            options.exact.scale.weight(),
                            options.exact.residual);
    const Moments draws = momentsOf(estimate.samples);
    const Moments reference = momentsOf(randomWalk(energy, draws, 10000));
    EXPECT_LT(divergence(reference, draws), 0.06)
        << toString(residual) << " " << toString(steps);
  }
}

TEST(Exact, EveryResidualAndKernelFindsTheTruth)
{
  const Scans scans;
  for (const auto residual : {Residual::PointToPoint,
                              Residual::PointToPlane,
                              Residual::DistributionToDistribution})
    for (const auto kernel :
         {RobustKernel::None, RobustKernel::Huber, RobustKernel::Tukey}) {
      Options options = exactOptions();
      options.exact.residual.residual = residual;
      options.exact.residual.kernel = kernel;
      options.exact.residual.kernel_width = 0.05;
      options.exact.residual.max_distance = 0.2;
      options.chains.num_draws = 800;
      const auto estimate =
          estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
      const auto& summary = estimate.summary;
      const std::string name =
          std::string(toString(residual)) + " " + toString(kernel) + ": ";
      EXPECT_EQ(summary.status, Status::Ok) << name << summary.message;
      const Vector6d error =
          poseError(scans.truth, summary.mean, CovarianceConvention::Parameters);
      const double squared = error.dot(summary.covariances[0].ldlt().solve(error));
      EXPECT_LT(squared, 22.5) << name; // chi-squared, 6 degrees, 99.9 %
    }
}

TEST(Exact, AKernelThatLeavesOutAllPointsIsADoubt)
{
  Scans scans;
  Options options = exactOptions();
  options.exact.residual.kernel = RobustKernel::Tukey;
  options.exact.residual.kernel_width = 0.05;
  const auto estimate =
      estimatePosterior(scans.source, scans.target, scans.truth, options);
  EXPECT_EQ(estimate.summary.status, Status::Ok) << estimate.summary.message;
  // A prior that holds the source far off the target, on the plateau of the kernel.
  Vector6d far = scans.truth;
  far[2] += 1.0;
  options.prior.variance = Vector6d::Constant(1e-4);
  const auto lost = estimatePosterior(scans.source, scans.target, far, options);
  EXPECT_EQ(lost.summary.status, Status::Doubtful) << lost.summary.message;
  EXPECT_NE(lost.summary.message.find("kernel of width 0.05 m"), std::string::npos)
      << lost.summary.message;
}

TEST(Exact, SteinParticlesAreBitIdenticalForEveryNumberOfThreads)
{
  const Scans scans;
  for (const auto steps : {ExactSteps::SteinGradient, ExactSteps::SteinNewton}) {
    Options options = exactOptions();
    options.exact.steps = steps;
    options.exact.num_particles = 21;
    options.chains.num_threads = 1;
    const auto reference =
        estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
    ASSERT_EQ(reference.samples.rows(), 21);
    for (const int num_threads : {2, 4}) {
      options.chains.num_threads = num_threads;
      const auto estimate =
          estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
      EXPECT_EQ(estimate.samples, reference.samples) << toString(steps);
    }
  }
}

TEST(Exact, ASearchOfTheUsersOwnGivesTheSamePosterior)
{
  const Scans scans(100);
  Options options = exactOptions();
  options.chains.num_draws = 400;
  options.exact.residual.max_distance = 0.3;
  options.exact.steps = ExactSteps::Langevin; // Metropolis takes brute force long.
  const test::BruteForceSearch search(scans.target.points().cast<double>(), 0.3, false);
  const auto a =
      estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
  const auto b = estimatePosterior(scans.source, search, Vector6d::Zero(), options);
  EXPECT_EQ(b.samples.rows(), 400);
  for (std::size_t k = 0; k < 6; ++k) {
    const auto &ca = a.summary.coordinates[k], &cb = b.summary.coordinates[k];
    EXPECT_NEAR(ca.mean, cb.mean, 5.0 * std::hypot(ca.mcse, cb.mcse)) << k;
    EXPECT_NEAR(std::log(ca.standard_deviation / cb.standard_deviation), 0.0, 0.25)
        << k;
  }
  for (const auto residual :
       {Residual::PointToPlane, Residual::DistributionToDistribution}) {
    options.exact.residual.residual = residual;
    EXPECT_EQ(estimatePosterior(scans.source, search, Vector6d::Zero(), options)
                  .summary.status,
              Status::InvalidOptions);
  }
}

TEST(Exact, OptionsAreChecked)
{
  const auto complaintOf = [](const std::function<void(Options&)>& set) {
    Options options = exactOptions();
    set(options);
    return options.validate();
  };
  EXPECT_EQ(complaintOf([](Options&) {}), "");
  const auto expect = [&](const char* field, const std::function<void(Options&)>& set) {
    EXPECT_NE(complaintOf(set).find(field), std::string::npos) << field;
  };
  expect("kernel_width", [](Options& o) { o.exact.residual.kernel_width = 0.0; });
  expect("max_distance", [](Options& o) { o.exact.residual.max_distance = -1.0; });
  expect("max_source_points", [](Options& o) { o.exact.max_source_points = 0; });
  expect("max_step_size", [](Options& o) { o.exact.max_step_size = 1.5; });
  expect("batch_size", [](Options& o) { o.exact.batch_size = 0; });
  expect("num_burn_in", [](Options& o) { o.exact.num_burn_in = -1; });
  expect("thinning", [](Options& o) { o.exact.thinning = 0; });
  expect("initial_spread", [](Options& o) {
    o.exact.initial_spread = Vector6d(Vector6d::Constant(-1.0));
  });
  expect("steps is metropolis", [](Options& o) {
    o.exact.batch_size = 10;
    o.exact.steps = ExactSteps::Metropolis;
  });
  expect("num_particles is 9", [](Options& o) {
    o.chains.num_chains = 10;
    o.exact.num_particles = 9;
    o.exact.steps = ExactSteps::SteinNewton;
  });
}

} // namespace
} // namespace bayesian_icp
