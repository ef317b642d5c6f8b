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

/** A wavy surface scanned twice. */
struct Scans {
  explicit Scans(Eigen::Index num_source = 300, Eigen::Index num_target = 6000)
  : source(test::wavySurface(91, num_source, 0.1))
  , target(test::moved(truth, test::wavySurface(92, num_target, 0.1)).cast<float>())
  {}

  Vector6d truth{0.01, -0.02, 0.015, 0.02, -0.03, 0.025};
  Eigen::Matrix3Xd source;
  KdTree target;
};

Options
exactOptions()
{
  Options options;
  options.preset = Preset::Exact;
  options.exact.scale.effective_points = 100.0;
  options.exact.scale.measurement_sigma = 0.01;
  options.exact.initial_spread = Vector6d(0.02, 0.02, 0.02, 0.05, 0.05, 0.05);
  return options;
}

PosteriorEstimate
estimateFrom(const Scans& scans, const Options& options)
{
  return estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options);
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

TEST(Exact, AutomaticSpreadOfStartsIsThePriorsButAtMostOneHalf)
{
  const Scans scans;
  Options options = exactOptions();
  options.chains.num_draws = 8;
  options.exact.num_burn_in = options.exact.thinning = 1;
  const Vector6d spread(0.5, 0.25, 0.125, 0.5, 0.25, 0.125);
  options.prior.variance = spread.cwiseAbs2();
  options.prior.variance[0] = options.prior.variance[3] = 4.0;
  options.exact.initial_spread = spread;
  const PosteriorEstimate stated = estimateFrom(scans, options);
  options.exact.initial_spread = automatic;
  ASSERT_GT(stated.samples.rows(), 0) << stated.summary.message;
  EXPECT_EQ(estimateFrom(scans, options).samples, stated.samples);
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
    const auto estimate = estimateFrom(scans, options);
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
    auto workspace = energy.makeWorkspace();
    Random random(93, 0);
    const Moments reference = momentsOf(test::randomWalk(
        [&](const Vector6d& pose) { return energy.energy(pose, workspace); },
        draws.mean,
        draws.covariance.llt().matrixL(),
        10000,
        4,
        random));
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
      const Summary summary = estimateFrom(scans, options).summary;
      SCOPED_TRACE(std::string(toString(residual)) + " " + toString(kernel));
      EXPECT_EQ(summary.status, Status::Ok) << summary.message;
      EXPECT_LT(
          test::squaredErrorOf(summary, scans.truth, CovarianceConvention::Parameters),
          test::chi_square_999);
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
    const PoseMatrix reference = estimateFrom(scans, options).samples;
    ASSERT_EQ(reference.rows(), 21);
    for (const int num_threads : {2, 4}) {
      options.chains.num_threads = num_threads;
      EXPECT_EQ(estimateFrom(scans, options).samples, reference) << toString(steps);
    }
  }
}

TEST(Exact, ASearchOfTheUsersOwnGivesTheSamePosterior)
{
  const Scans scans(100, 600); // few, because brute force looks at all
  Options options = exactOptions();
  options.chains.num_draws = 400;
  options.exact.residual.max_distance = 0.3;
  options.exact.steps = ExactSteps::Langevin; // Metropolis takes brute force long.
  const test::BruteForceSearch search(scans.target.points().cast<double>(), 0.3, false);
  options.chains.num_threads = 2;
  const auto a = estimateFrom(scans, options);
  options.exact.max_source_points = 50; // not for a search that knows all points
  const auto b = estimatePosterior(scans.source, search, Vector6d::Zero(), options);
  EXPECT_EQ(b.samples.rows(), 400);
  EXPECT_EQ(search.largestIndex(), 99U);
  EXPECT_EQ(search.mostAtOnce(), 1);
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

TEST(Exact, TwoTargetPointsHaveNoSurface)
{
  const Scans scans;
  Options options = exactOptions();
  const auto statusWith = [&](Residual residual) {
    options.exact.residual.residual = residual;
    return estimatePosterior(scans.source,
                             KdTree(scans.target.points().leftCols(2)),
                             Vector6d::Zero(),
                             options)
        .summary.status;
  };
  EXPECT_NE(statusWith(Residual::PointToPoint), Status::TooFewCorrespondences);
  EXPECT_EQ(statusWith(Residual::PointToPlane), Status::TooFewCorrespondences);
  EXPECT_EQ(statusWith(Residual::DistributionToDistribution),
            Status::TooFewCorrespondences);
}

TEST(Exact, OptionsAreChecked)
{
  EXPECT_EQ(exactOptions().validate(), "");
  // The command line's test has the other fields.
  const auto expect = [](const char* field, const std::function<void(Options&)>& set) {
    Options options = exactOptions();
    set(options);
    EXPECT_NE(options.validate().find(field), std::string::npos) << field;
  };
  expect("preset is 7", [](Options& o) { o.preset = static_cast<Preset>(7); });
  expect("frame is 9", [](Options& o) { o.prior.frame = static_cast<PriorFrame>(9); });
  expect("residual is 3",
         [](Options& o) { o.exact.residual.residual = static_cast<Residual>(3); });
  expect("kernel is 3",
         [](Options& o) { o.exact.residual.kernel = static_cast<RobustKernel>(3); });
  expect("regularization is -1", [](Options& o) {
    o.exact.residual.regularization = static_cast<CovarianceRegularization>(-1);
  });
  expect("steps is 9", [](Options& o) { o.exact.steps = static_cast<ExactSteps>(9); });
  expect("sampling is 5", [](Options& o) {
    o.preset = Preset::Paper;
    o.paper.sampling = static_cast<MiniBatchSampling>(5);
  });
  expect("variance[y]", [](Options& o) { o.prior.variance[1] = 1e-25; });
  expect("max_distance", [](Options& o) { o.exact.residual.max_distance = -1.0; });
  expect("batch_size", [](Options& o) { o.exact.batch_size = 0; });
  expect("num_burn_in", [](Options& o) { o.exact.num_burn_in = -1; });
  expect("thinning", [](Options& o) { o.exact.thinning = 0; });
  expect("initial_spread", [](Options& o) {
    o.exact.initial_spread = Vector6d(Vector6d::Constant(-1.0));
  });
}

} // namespace
} // namespace bayesian_icp
