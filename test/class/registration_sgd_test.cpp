// pcl::StochasticGradientDescentIterativeClosestPoint as a drop-in registration.
#include "support/registration_support.h"

#include <pcl/registration/stochastic_gradient_icp.h>
#include <pcl/registration/transformation_estimation_2D.h>

namespace pcl::test {
namespace {

using bayesian_icp::DescentEnd;
using bayesian_icp::SgdOptimizer;
using SgdIcp = StochasticGradientDescentIterativeClosestPoint<PointXYZ, PointXYZ>;
using Criteria = registration::DefaultConvergenceCriteria<float>;

struct Exposed : SgdIcp {
  using SgdIcp::correspondences_;
  using SgdIcp::nr_iterations_;
};

/** Steps of the size of an object of 1 m. */
void
useGentleSteps(SgdIcp& icp)
{
  icp.setOptimizer(SgdOptimizer::Momentum);
  icp.setMaximumIterations(400);
}

using SgdRegistration = ScansTest;

TEST_F(SgdRegistration, HasNoResultBeforeAlign)
{
  const SgdIcp icp;
  EXPECT_EQ(icp.getClassName(), "StochasticGradientDescentIterativeClosestPoint");
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getResult().num_iterations, 0);
}

TEST_F(SgdRegistration, TheOutputIsTheSourceMovedByTheFinalTransformation)
{
  Exposed icp;
  useGentleSteps(icp);
  align(icp);
  EXPECT_TRUE(icp.hasConverged());
  expectMoved(output, *scans.source, icp.getFinalTransformation());
  EXPECT_EQ(icp.getFinalTransformation(),
            bayesian_icp::matrixOf(icp.getResult().pose).cast<float>().eval());
  EXPECT_EQ(icp.nr_iterations_, icp.getResult().num_iterations);
  EXPECT_EQ(icp.correspondences_->size(), scans.source->size());
  // The mean squared distance of the pairs is what PCL calls the fitness.
  double sum = 0.0;
  for (const auto& pair : *icp.correspondences_)
    sum += pair.distance;
  EXPECT_NEAR(icp.getFitnessScore(),
              sum / static_cast<double>(output.size()),
              1e-5 * icp.getFitnessScore());
}

TEST_F(SgdRegistration, ComesNearerToTheTruthThanItStarted)
{
  for (const SgdOptimizer optimizer : {SgdOptimizer::FixedStep,
                                       SgdOptimizer::Momentum,
                                       SgdOptimizer::AdaDelta,
                                       SgdOptimizer::Adam,
                                       SgdOptimizer::RmsProp}) {
    SgdIcp icp;
    icp.setOptimizer(optimizer);
    align(icp);
    Cloud at_truth;
    transformPointCloud(*scans.source,
                        at_truth,
                        bayesian_icp::matrixOf(smallPose()).cast<float>().eval());
    double sum = 0.0, sum_at_start = 0.0;
    for (std::size_t i = 0; i < output.size(); ++i) {
      const Eigen::Vector3f truth = at_truth[i].getVector3fMap();
      sum += (output[i].getVector3fMap() - truth).squaredNorm();
      sum_at_start += ((*scans.source)[i].getVector3fMap() - truth).squaredNorm();
    }
    EXPECT_LT(sum, sum_at_start) << toString(optimizer);
  }
}

TEST_F(SgdRegistration, TheFinalTransformationIncludesTheGuess)
{
  bayesian_icp::Vector6d far = smallPose();
  far[0] += 0.02;
  const Eigen::Matrix4f guess = bayesian_icp::matrixOf(far).cast<float>();
  SgdIcp icp;
  useGentleSteps(icp);
  icp.setMaximumIterations(1);
  align(icp, guess);
  EXPECT_TRUE(icp.hasConverged());
  const Eigen::Matrix4f step = icp.getLastIncrementalTransformation();
  EXPECT_LT((step * guess - icp.getFinalTransformation()).norm(), 1e-6f);
  EXPECT_GT((step - Eigen::Matrix4f::Identity()).norm(), 1e-4f);
}

TEST_F(SgdRegistration, EpsilonsAndIterationsArePclsSettings)
{
  SgdIcp icp;
  const bayesian_icp::StochasticGradientIcpOptions defaults;
  EXPECT_EQ(icp.getMaximumIterations(), defaults.max_iterations);
  EXPECT_NEAR(
      icp.getOptions().translation_epsilon, defaults.translation_epsilon, 1e-15);
  // The cosine of a small angle a is known to 1e-16, so the angle to 1e-16 / a.
  EXPECT_NEAR(icp.getOptions().rotation_epsilon, defaults.rotation_epsilon, 1e-13);
  icp.setTransformationEpsilon(1e-6);
  EXPECT_NEAR(icp.getOptions().translation_epsilon, 1e-3, 1e-15);
  EXPECT_NEAR(icp.getOptions().rotation_epsilon, defaults.rotation_epsilon, 1e-13);
  icp.setTransformationRotationEpsilon(std::cos(0.25));
  EXPECT_NEAR(icp.getOptions().rotation_epsilon, 0.25, 1e-14);
  icp.setTransformationRotationEpsilon(0.0); // as in PCL: of the other epsilon
  EXPECT_NEAR(icp.getOptions().rotation_epsilon, std::acos(1.0 - 1e-6), 1e-12);
  auto options = icp.getOptions();
  options.max_iterations = 3;
  options.translation_epsilon = 0.5;
  icp.setOptions(options);
  EXPECT_EQ(icp.getMaximumIterations(), 3);
  EXPECT_EQ(icp.getTransformationEpsilon(), 0.25);
}

TEST_F(SgdRegistration, RunningOutOfIterationsIsConvergenceUnlessToldOtherwise)
{
  SgdIcp icp;
  icp.setMaximumIterations(2);
  align(icp);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getConvergeCriteria()->getConvergenceState(),
            Criteria::CONVERGENCE_CRITERIA_ITERATIONS);
  EXPECT_EQ(icp.getResult().end, DescentEnd::MaxIterations);
  icp.getConvergeCriteria()->setFailureAfterMaximumIterations(true);
  align(icp);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getConvergeCriteria()->getConvergenceState(),
            Criteria::CONVERGENCE_CRITERIA_FAILURE_AFTER_MAX_ITERATIONS);
  icp.setMaximumIterations(0); // once, as in PCL
  align(icp);
  EXPECT_EQ(icp.getResult().num_iterations, 1);
}

TEST_F(SgdRegistration, IsRepeatableAndThatOfItsSeed)
{
  SgdIcp icp;
  align(icp);
  const Eigen::Matrix4f first = icp.getFinalTransformation();
  icp.setSeed(77);
  align(icp, bayesian_icp::matrixOf(smallPose()).cast<float>());
  align(icp);
  EXPECT_NE(icp.getFinalTransformation(), first);
  icp.setSeed(bayesian_icp::StochasticGradientIcpOptions().seed);
  align(icp);
  EXPECT_EQ(icp.getFinalTransformation(), first);
}

TEST_F(SgdRegistration, BadGuessesAndOptionsFailWithoutHarm)
{
  SgdIcp icp;
  Eigen::Matrix4f scaled = Eigen::Matrix4f::Identity();
  scaled.topLeftCorner<3, 3>() *= 0.9f;
  align(icp, scaled);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getResult().end, DescentEnd::InvalidInput);
  EXPECT_EQ(output.size(), scans.source->size());
  align(icp);
  EXPECT_TRUE(icp.hasConverged());
  icp.setStepSize(-1.0);
  align(icp);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getResult().end, DescentEnd::InvalidInput);
}

TEST_F(SgdRegistration, AStepBeyondTheRangeOfScalarIsDivergence)
{
  SgdIcp icp;
  icp.setOptimizer(SgdOptimizer::FixedStep);
  icp.setStepSize(1e60); // poses that a double can hold
  align(icp);
  EXPECT_EQ(icp.getResult().end, DescentEnd::Diverged);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_TRUE(icp.getFinalTransformation().allFinite());
}

TEST_F(SgdRegistration, ADistanceRejectorActsAsTheGate)
{
  SgdIcp gated, rejecting;
  gated.setMaxCorrespondenceDistance(0.03);
  align(gated);
  rejecting.addCorrespondenceRejector(rejectorBeyond(0.03f));
  align(rejecting);
  EXPECT_LT(
      (rejecting.getFinalTransformation() - gated.getFinalTransformation()).norm(),
      1e-6f);
  SgdIcp plain;
  align(plain);
  EXPECT_NE(plain.getFinalTransformation(), gated.getFinalTransformation());
}

TEST_F(SgdRegistration, OwnEstimationIsAskedByEveryStep)
{
  SgdIcp plain, own;
  const auto estimation = pcl::make_shared<CountingEstimation>();
  own.setCorrespondenceEstimation(estimation);
  align(plain);
  align(own);
  EXPECT_EQ(own.getResult().num_iterations, plain.getResult().num_iterations);
  // Once more for the correspondences at the end.
  EXPECT_EQ(estimation->num_calls, own.getResult().num_iterations + 1);
  EXPECT_LT((own.getFinalTransformation() - plain.getFinalTransformation()).norm(),
            1e-5f);
}

TEST_F(SgdRegistration, StaysWithinWhatAPlanarEstimationAllows)
{
  SgdIcp icp;
  useGentleSteps(icp);
  using Planar = registration::TransformationEstimation2D<PointXYZ, PointXYZ>;
  icp.setTransformationEstimation(pcl::make_shared<Planar>());
  align(icp);
  const Eigen::Matrix4f T = icp.getFinalTransformation();
  EXPECT_EQ(T.row(2), Eigen::RowVector4f(0.0f, 0.0f, 1.0f, 0.0f));
  EXPECT_EQ(T.col(2), Eigen::Vector4f(0.0f, 0.0f, 1.0f, 0.0f));
  EXPECT_NE(T, Eigen::Matrix4f::Identity());
}

TEST_F(SgdRegistration, VisualizationCallbackIsCalledOnceAStep)
{
  SgdIcp icp;
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  int num_calls = 0;
  std::function<SgdIcp::UpdateVisualizerCallbackSignature> callback =
      [&](const Cloud& source, const Indices& in_source, const Cloud&, const Indices&) {
        ++num_calls;
        EXPECT_EQ(source.size(), scans.source->size());
        EXPECT_EQ(in_source.size(), num_calls == 1 ? 0 : source.size());
      };
  icp.registerVisualizationCallback(callback); // calls it at once, without pairs
  icp.align(output);
  EXPECT_EQ(num_calls, 1 + icp.getResult().num_iterations);
}

TEST_F(SgdRegistration, DoubleKeepsTheRotationOrthonormalAndNormalsAreTurned)
{
  Scans<PointNormal> with_normals;
  for (auto& point : *with_normals.source)
    point.getNormalVector3fMap() = Eigen::Vector3f::UnitZ();
  StochasticGradientDescentIterativeClosestPoint<PointNormal, PointNormal, double> icp;
  const auto moved = aligned(icp, with_normals.source, with_normals.target);
  const Eigen::Matrix3d R = icp.getFinalTransformation().topLeftCorner<3, 3>();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  const Eigen::Vector3f normal = moved[3].getNormalVector3fMap();
  EXPECT_LT((normal - R.col(2).cast<float>()).norm(), 1e-6f);
  EXPECT_NE(normal, Eigen::Vector3f::UnitZ());
}

} // namespace
} // namespace pcl::test
