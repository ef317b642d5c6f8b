// pcl::BayesianIterativeClosestPoint as a drop-in for pcl::IterativeClosestPoint: the
// same registration, and the posterior on top.
#include "support/registration_support.h"

#include <pcl/registration/incremental_registration.h>

#include <gtest/gtest.h>

#include <limits>

namespace pcl {
namespace test {
namespace {

const float nan_value = std::numeric_limits<float>::quiet_NaN();

/** Exposes what subclasses of ICP read after align(). */
struct Exposed : BayesianIcp {
  using BayesianIcp::correspondences_;
};

TEST(DropIn, HasThePublicMembersOfIcp)
{
  BayesianIcp icp;
  EXPECT_EQ(icp.convergence_criteria_, icp.getConvergeCriteria());
  EXPECT_EQ(icp.getClassName(), "BayesianIterativeClosestPoint");
}

TEST(DropIn, IsHeldByThePointersOfItsBases)
{
  const Scans<PointXYZ> scans;
  Icp::Ptr icp(new BayesianIcp);
  dynamic_cast<BayesianIcp&>(*icp).setNumberOfSamples(40);
  Registration<PointXYZ, PointXYZ>::Ptr registration = icp;
  registration->setInputSource(scans.source);
  registration->setInputTarget(scans.target);
  const QuietConsole quiet;
  Cloud output;
  registration->align(output);
  EXPECT_TRUE(registration->hasConverged());
  EXPECT_EQ(registration->getClassName(), "BayesianIterativeClosestPoint");
  EXPECT_EQ(dynamic_cast<BayesianIcp&>(*icp).getSamples().rows(), 40);
}

TEST(DropIn, WorksInIncrementalRegistration)
{
  const Scans<PointXYZ> scans;
  BayesianIcp::Ptr icp(new BayesianIcp);
  useFewSamples(*icp);
  icp->setMaximumIterations(100);
  registration::IncrementalRegistration<PointXYZ> incremental;
  incremental.setRegistration(icp);
  const QuietConsole quiet;
  EXPECT_TRUE(incremental.registerCloud(scans.target));
  EXPECT_TRUE(incremental.registerCloud(scans.source));
  EXPECT_EQ(incremental.getDeltaTransform(), icp->getFinalTransformation());
}

TEST(DropIn, AlignIntoTheSourceGivesTheSamePoseAndPosterior)
{
  const Scans<PointXYZ> scans;
  const QuietConsole quiet;
  Cloud output;
  BayesianIcp apart, in_place;
  for (auto* icp : {&apart, &in_place}) {
    useFewSamples(*icp);
    icp->setInputTarget(scans.target);
  }
  apart.setInputSource(scans.source);
  apart.align(output);
  in_place.setInputSource(scans.source);
  in_place.align(*scans.source);
  EXPECT_EQ(in_place.getFinalTransformation(), apart.getFinalTransformation());
  EXPECT_EQ(in_place.getSamples(), apart.getSamples());
  for (std::size_t i = 0; i < output.size(); ++i)
    ASSERT_EQ((*scans.source)[i].getVector4fMap(), output[i].getVector4fMap());
}

TEST(DropIn, KeepsFieldsAndRotatesNormals)
{
  Scans<PointXYZRGBNormal> scans;
  for (std::size_t i = 0; i < scans.source->size(); ++i) {
    auto& point = (*scans.source)[i];
    point.rgba = static_cast<std::uint32_t>(i * 77777);
    point.curvature = static_cast<float>(i) * 0.1f;
    point.getNormalVector3fMap() = Eigen::Vector3f(0.6f, 0.0f, 0.8f);
  }
  scans.source->header.frame_id = "camera";
  scans.source->header.stamp = 123456;
  BayesianIterativeClosestPoint<PointXYZRGBNormal, PointXYZRGBNormal> icp;
  useFewSamples(icp);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  const QuietConsole quiet;
  PointCloud<PointXYZRGBNormal> output;
  icp.align(output);
  const Eigen::Matrix3f R = icp.getFinalTransformation().topLeftCorner<3, 3>();
  ASSERT_EQ(output.size(), scans.source->size());
  EXPECT_EQ(output.header.frame_id, "camera");
  EXPECT_EQ(output.header.stamp, 123456u);
  for (std::size_t i = 0; i < output.size(); ++i) {
    EXPECT_EQ(output[i].rgba, (*scans.source)[i].rgba);
    EXPECT_EQ(output[i].curvature, (*scans.source)[i].curvature);
    EXPECT_LT((output[i].getNormalVector3fMap() - R * Eigen::Vector3f(0.6f, 0.0f, 0.8f))
                  .norm(),
              1e-6f);
  }
}

template <typename PointT>
class EveryInstantiation : public ::testing::Test {};
using PointTypes = ::testing::Types<PointXYZ,
                                    PointXYZI,
                                    PointXYZRGB,
                                    PointXYZRGBA,
                                    PointNormal,
                                    PointXYZRGBNormal,
                                    PointXYZINormal>;
TYPED_TEST_SUITE(EveryInstantiation, PointTypes, );

template <typename PointT, typename Scalar>
bayesian_icp::PoseMatrix
drawsOf()
{
  const Scans<PointT> scans;
  BayesianIterativeClosestPoint<PointT, PointT, Scalar> icp;
  useFewSamples(icp);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  PointCloud<PointT> output;
  icp.align(output);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_LT((icp.getMeanTransformation() -
             bayesian_icp::matrixOf(icp.getMean()).template cast<Scalar>())
                .norm(),
            Scalar(1e-6));
  return (icp.getSamples());
}

TYPED_TEST(EveryInstantiation, GivesTheSameDraws)
{
  const QuietConsole quiet;
  const auto reference = drawsOf<PointXYZ, double>();
  EXPECT_EQ((drawsOf<TypeParam, float>()), reference);
  EXPECT_EQ((drawsOf<TypeParam, double>()), reference);
}

TEST(Posterior, IsEmptyBeforeAlign)
{
  const BayesianIcp icp;
  EXPECT_EQ(icp.getSamples().rows(), 0);
  EXPECT_EQ(icp.getChain(0).rows(), 0);
  EXPECT_TRUE(icp.getMean().array().isNaN().all());
  EXPECT_TRUE(icp.getCovariance().array().isNaN().all());
  EXPECT_TRUE(icp.getCovariance(bayesian_icp::CovarianceConvention::LeftSE3)
                  .array()
                  .isNaN()
                  .all());
  EXPECT_TRUE(icp.getMeanTransformation().topRows<3>().array().isNaN().all());
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::NotRun);
}

TEST(Posterior, HasTheDrawsThatWereAskedFor)
{
  const Scans<PointXYZ> scans;
  BayesianIcp icp;
  icp.setNumberOfSamples(103);
  icp.setNumberOfChains(4);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  const QuietConsole quiet;
  Cloud output;
  icp.align(output);
  ASSERT_EQ(icp.getSamples().rows(), 103);
  EXPECT_EQ(icp.getChain(0).rows(), 26);
  EXPECT_EQ(icp.getChain(3).rows(), 25);
  EXPECT_EQ(icp.getChain(4).rows(), 0);
  EXPECT_EQ(icp.getSamples().topRows(26), icp.getChain(0));
  EXPECT_EQ(icp.getSummary().num_draws, 103);
}

TEST(Posterior, IsRepeatableAndIndependentOfThreads)
{
  const Scans<PointXYZ> scans;
  const QuietConsole quiet;
  Cloud output;
  const auto draws = [&](unsigned int num_threads, std::uint64_t seed) {
    BayesianIcp icp;
    useFewSamples(icp);
    icp.setNumberOfThreads(num_threads);
    icp.setSeed(seed);
    icp.setInputSource(scans.source);
    icp.setInputTarget(scans.target);
    icp.align(output);
    auto first = icp.getSamples();
    icp.align(output); // a second align is independent of the first
    EXPECT_EQ(icp.getSamples(), first);
    return (first);
  };
  const auto reference = draws(1, 1);
  for (const unsigned int num_threads : {0, 2, 3, 8})
    EXPECT_EQ(draws(num_threads, 1), reference);
  EXPECT_NE(draws(1, 2), reference);
}

TEST(Posterior, IncludesTheGuessAndHasItAsPriorMean)
{
  // A source that is far away and brought back by the guess: the draws are of the whole
  // source-to-target pose.
  const Scans<PointXYZ> scans;
  bayesian_icp::Vector6d far;
  far << 10, -5, 3, 0.5, -0.3, 2.0;
  const Eigen::Matrix4f away = bayesian_icp::matrixOf(far).inverse().cast<float>();
  Cloud::Ptr source(new Cloud);
  transformPointCloud(*scans.source, *source, away);
  BayesianIcp icp;
  icp.setNumberOfSamples(400);
  icp.setInputSource(source);
  icp.setInputTarget(scans.target);
  const QuietConsole quiet;
  Cloud output;
  icp.align(output, bayesian_icp::matrixOf(far).cast<float>());
  const auto error = bayesian_icp::poseError(
      icp.getMean(), far, bayesian_icp::CovarianceConvention::R3xSO3);
  EXPECT_LT(error.head<3>().norm(), 2.0);
  EXPECT_LT(error.tail<3>().norm(), 0.2);
}

TEST(Calibrated, RefusesAScale)
{
  const Scans<PointXYZ> scans;
  const QuietConsole quiet;
  Cloud output;
  BayesianIcp icp;
  useFewSamples(icp);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  icp.setMeasurementSigma(1.0); // the default, and yet stated
  icp.align(output);
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidOptions);
  EXPECT_NE(icp.getSummary().message.find("measurement_sigma"), std::string::npos);
  EXPECT_EQ(icp.getSamples().rows(), 0);
  EXPECT_TRUE(icp.hasConverged());
  icp.setOptions(icp.getOptions());
  icp.align(output);
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

TEST(Paper, HasAGateThatIsTheSmallerOfItsOwnAndPcls)
{
  const Scans<PointXYZ> scans;
  Cloud output;
  const auto draws = [&](double gate, double pcl_gate) {
    BayesianIcp icp;
    usePaper(icp);
    auto options = icp.getOptions();
    options.paper.sgld.step_size = 1e-7;
    options.paper.max_distance = gate;
    icp.setOptions(options);
    icp.setMaximumIterations(1);
    icp.setMaxCorrespondenceDistance(pcl_gate);
    icp.setInputSource(scans.source);
    icp.setInputTarget(scans.target);
    icp.align(output);
    return (icp.getSamples());
  };
  const auto gated = draws(0.03, 100.0);
  EXPECT_EQ(gated, draws(100.0, 0.03));
  EXPECT_NE(gated, draws(100.0, 100.0));
}

TEST(Posterior, CanBeCancelledAndTheObjectUsedAgain)
{
  const Scans<PointXYZ> scans;
  BayesianIcp icp;
  useFewSamples(icp);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  icp.setProgressCallback(
      [](const bayesian_icp::Progress& p) { return (p.steps < 10); });
  const QuietConsole quiet;
  Cloud output;
  icp.align(output);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::Cancelled);
  icp.setProgressCallback(nullptr);
  icp.align(output);
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

TEST(Posterior, MeanAsFinalTransformationMovesTheOutput)
{
  const Scans<PointXYZ> scans;
  BayesianIcp icp;
  useFewSamples(icp);
  icp.setUseMeanAsFinalTransformation(true);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  const QuietConsole quiet;
  Cloud output;
  icp.align(output);
  EXPECT_EQ(icp.getFinalTransformation(), icp.getMeanTransformation());
  Cloud expected;
  transformPointCloud(*scans.source, expected, icp.getMeanTransformation());
  for (std::size_t i = 0; i < output.size(); ++i)
    ASSERT_LT((output[i].getVector3fMap() - expected[i].getVector3fMap()).norm(),
              1e-6f);
}

TEST(BadInput, NaNSourcePointsAreSkippedAndKept)
{
  Scans<PointXYZ> scans;
  const Cloud::Ptr clean(new Cloud(*scans.source));
  for (const std::size_t i : {0u, 17u, 500u}) {
    PointXYZ hole(1.0f, nan_value, 2.0f);
    scans.source->insert(scans.source->begin() + static_cast<std::ptrdiff_t>(i), hole);
  }
  const QuietConsole quiet;
  Exposed with_holes;
  BayesianIcp without;
  Cloud output, expected;
  useFewSamples(with_holes);
  useFewSamples(without);
  with_holes.setInputSource(scans.source);
  without.setInputSource(clean);
  with_holes.setInputTarget(scans.target);
  without.setInputTarget(scans.target);
  with_holes.align(output);
  without.align(expected);
  EXPECT_EQ(with_holes.getFinalTransformation(), without.getFinalTransformation());
  EXPECT_EQ(with_holes.getSamples(), without.getSamples());
  EXPECT_EQ(with_holes.getFitnessScore(), without.getFitnessScore());
  ASSERT_EQ(output.size(), scans.source->size());
  EXPECT_TRUE(std::isnan(output[17].y));
  EXPECT_EQ(output[1].getVector3fMap(), expected[0].getVector3fMap());
  for (const auto& pair : *with_holes.correspondences_)
    EXPECT_TRUE(isXYZFinite((*scans.source)[pair.index_query]));
}

TEST(BadInput, SourcePointsTooFarForFloatDistancesAreSkipped)
{
  const Scans<PointXYZ> scans;
  const Cloud::Ptr with_far_points(new Cloud(*scans.source));
  with_far_points->push_back(PointXYZ(1e30f, 0.0f, 0.0f));
  with_far_points->push_back(PointXYZ(0.0f, -3e38f, 3e38f));
  const QuietConsole quiet;
  BayesianIcp icp, reference;
  Cloud output;
  for (auto* registration : {&icp, &reference}) {
    useFewSamples(*registration);
    registration->setInputTarget(scans.target);
    registration->setInputSource(registration == &icp ? with_far_points : scans.source);
    registration->align(output);
  }
  EXPECT_EQ(icp.getFinalTransformation(), reference.getFinalTransformation());
  EXPECT_EQ(icp.getSamples(), reference.getSamples());
  EXPECT_EQ(icp.getFitnessScore(), reference.getFitnessScore());
}

void
alignQuietly(const Scans<PointXYZ>& scans, BayesianIcp& icp)
{
  useFewSamples(icp);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  const QuietConsole quiet;
  Cloud output;
  icp.align(output);
}

TEST(BadInput, TargetPointsThatAreTooFarAreIgnored)
{
  Scans<PointXYZ> scans;
  Eigen::Matrix4f results[2];
  const float coordinates[2] = {nan_value, std::numeric_limits<float>::max()};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 40; ++k) // more than a leaf of PCL's tree has
      (*scans.target)[k].x = coordinates[i] * (1.0f - 0.01f * static_cast<float>(k));
    BayesianIcp icp;
    alignQuietly(scans, icp);
    EXPECT_TRUE(icp.getSamples().allFinite());
    results[i] = icp.getFinalTransformation();
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(BadInput, AGuessThatIsNotRigidHasNoPosterior)
{
  const Scans<PointXYZ> scans;
  const QuietConsole quiet;
  Eigen::Matrix4f scaled = Eigen::Matrix4f::Identity();
  scaled.topLeftCorner<3, 3>() *= 0.9f;
  Eigen::Matrix4f mirrored = Eigen::Matrix4f::Identity();
  mirrored(2, 2) = -1.0f;
  for (const auto& guess : {scaled, mirrored}) {
    BayesianIcp icp;
    useFewSamples(icp);
    icp.setInputSource(scans.source);
    icp.setInputTarget(scans.target);
    Cloud output;
    icp.align(output, guess);
    EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidInput);
    EXPECT_EQ(icp.getSamples().rows(), 0);
  }
}

/** A registration that has to fail without harm, and be usable afterwards. */
void
expectFailure(const Cloud::Ptr& source,
              const Cloud::Ptr& target,
              const Eigen::Matrix4f& guess,
              double max_distance)
{
  const QuietConsole quiet;
  BayesianIcp icp;
  useFewSamples(icp);
  icp.setMaxCorrespondenceDistance(max_distance);
  icp.setInputSource(source);
  icp.setInputTarget(target);
  Cloud output;
  icp.align(output, guess);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getConvergeCriteria()->getConvergenceState(),
            registration::DefaultConvergenceCriteria<
                float>::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES);
  EXPECT_TRUE(icp.getSummary().status == bayesian_icp::Status::TooFewCorrespondences ||
              icp.getSummary().status == bayesian_icp::Status::InvalidInput);
  EXPECT_EQ(icp.getSamples().rows(), 0);
  EXPECT_TRUE(icp.getCovariance().array().isNaN().all());
  EXPECT_EQ(output.size(), source->size());
  if (guess.allFinite()) {
    EXPECT_EQ(icp.getFinalTransformation(), guess);
  }

  const Scans<PointXYZ> good;
  icp.setInputSource(good.source);
  icp.setInputTarget(good.target);
  icp.setMaxCorrespondenceDistance(10.0);
  icp.align(output);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

Cloud::Ptr
cloudOf(const std::vector<PointXYZ>& points)
{
  Cloud::Ptr cloud(new Cloud);
  for (const auto& point : points)
    cloud->push_back(point);
  return (cloud);
}

TEST(BadInput, CloudsThatCannotBeRegisteredFail)
{
  const Scans<PointXYZ> scans;
  const auto no_source = cloudOf(std::vector<PointXYZ>(10, PointXYZ(nan_value, 0, 0)));
  const auto no_target = cloudOf(std::vector<PointXYZ>(10, PointXYZ(0, 0, nan_value)));
  const auto two_points = cloudOf({PointXYZ(0, 0, 0), PointXYZ(1, 0, 0)});
  const Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  expectFailure(no_source, scans.target, guess, 1.0);
  expectFailure(scans.source, no_target, guess, 1.0);
  expectFailure(two_points, scans.target, guess, 10.0);
}

TEST(BadInput, GuessesThatAreOfNoUseFail)
{
  const Scans<PointXYZ> scans;
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(0, 3) = 100.0f; // no overlap
  expectFailure(scans.source, scans.target, guess, 0.1);
  guess(0, 3) = 0.0f;
  guess(1, 1) = nan_value;
  expectFailure(scans.source, scans.target, guess, 10.0);
  for (const float x : {1e30f, 3e38f}) { // too far for distances of floats
    guess.setIdentity();
    guess.topRightCorner<3, 1>().setConstant(x);
    guess(0, 0) = x;
    expectFailure(scans.source, scans.target, guess, 10.0);
  }
}

TEST(BadInput, GuessBeyondTheRangeOfFloatFails)
{
  const Scans<PointXYZ> scans;
  BayesianIterativeClosestPoint<PointXYZ, PointXYZ, double> icp;
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  guess(0, 3) = 1e300;
  const QuietConsole quiet;
  Cloud output;
  icp.align(output, guess);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidInput);
  EXPECT_EQ(output[0].getVector3fMap(), (*scans.source)[0].getVector3fMap());
}

} // namespace
} // namespace test
} // namespace pcl
