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

/** What a user may change before align(). */
struct Settings {
  std::string name;
  std::function<void(Icp&)> apply;
  bayesian_icp::Vector6d guess;
};

void
PrintTo(const Settings& settings, std::ostream* stream)
{
  *stream << settings.name;
}

std::vector<Settings>
allSettings()
{
  const bayesian_icp::Vector6d none = bayesian_icp::Vector6d::Zero();
  bayesian_icp::Vector6d guess;
  guess << 0.01, 0.01, -0.02, 0.02, 0.03, -0.04;
  return {
      {"Defaults", [](Icp&) {}, none},
      {"Guess", [](Icp&) {}, guess},
      {"Gate", [](Icp& icp) { icp.setMaxCorrespondenceDistance(0.02); }, none},
      {"NoIterations", [](Icp& icp) { icp.setMaximumIterations(0); }, none},
      {"OneIteration", [](Icp& icp) { icp.setMaximumIterations(1); }, none},
      {"ManyIterations",
       [](Icp& icp) {
         icp.setMaximumIterations(200);
         icp.setTransformationEpsilon(1e-10);
       },
       guess},
      {"FitnessEpsilon", [](Icp& icp) { icp.setEuclideanFitnessEpsilon(0.1); }, none},
      {"Reciprocal", [](Icp& icp) { icp.setUseReciprocalCorrespondences(true); }, none},
      {"FailureAfterMaxIterations",
       [](Icp& icp) {
         icp.setMaximumIterations(3);
         icp.getConvergeCriteria()->setFailureAfterMaximumIterations(true);
       },
       none}};
}

/** Exposes what subclasses of ICP read after align(). */
template <typename Base>
struct Exposed : Base {
  using Base::correspondences_;
  using Base::nr_iterations_;
  using Base::previous_transformation_;
  using Base::transformation_;
};

template <typename Registration>
void
run(Registration& icp,
    const Settings& settings,
    const Scans<PointXYZ>& scans,
    Cloud& output)
{
  settings.apply(icp);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  icp.align(output, bayesian_icp::matrixOf(settings.guess).cast<float>());
}

class DropIn : public ::testing::TestWithParam<Settings> {};

TEST_P(DropIn, GivesExactlyTheRegistrationOfIcp)
{
  const Scans<PointXYZ> scans;
  Exposed<Icp> icp;
  Exposed<BayesianIcp> bayesian;
  useFewSamples(bayesian);
  const QuietConsole quiet;
  Cloud expected, actual;
  run(icp, GetParam(), scans, expected);
  run(bayesian, GetParam(), scans, actual);

  EXPECT_EQ(bayesian.getFinalTransformation(), icp.getFinalTransformation());
  EXPECT_EQ(bayesian.getLastIncrementalTransformation(),
            icp.getLastIncrementalTransformation());
  EXPECT_EQ(bayesian.hasConverged(), icp.hasConverged());
  EXPECT_EQ(bayesian.getConvergeCriteria()->getConvergenceState(),
            icp.getConvergeCriteria()->getConvergenceState());
  EXPECT_EQ(bayesian.nr_iterations_, icp.nr_iterations_);
  EXPECT_EQ(bayesian.previous_transformation_, icp.previous_transformation_);
  EXPECT_EQ(bayesian.correspondences_->size(), icp.correspondences_->size());
  EXPECT_EQ(bayesian.getFitnessScore(), icp.getFitnessScore());
  EXPECT_EQ(bayesian.getFitnessScore(1e-4), icp.getFitnessScore(1e-4));
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i)
    ASSERT_EQ(actual[i].getVector4fMap(), expected[i].getVector4fMap());
}

INSTANTIATE_TEST_SUITE_P(ForEverySetting,
                         DropIn,
                         ::testing::ValuesIn(allSettings()),
                         [](const auto& setting) { return setting.param.name; });

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

TEST(DropIn, SteppingOneIterationAtATimeWorks)
{
  // As in PCL's interactive_icp tutorial: the output is the source of the next align.
  const Scans<PointXYZ> scans;
  const auto step = [&](Icp& icp) {
    Cloud::Ptr moving(new Cloud(*scans.source));
    icp.setMaximumIterations(1);
    icp.setInputTarget(scans.target);
    icp.setInputSource(moving);
    for (int i = 0; i < 10; ++i)
      icp.align(*moving);
    return (moving);
  };
  BayesianIcp bayesian;
  useFewSamples(bayesian);
  Icp icp;
  const QuietConsole quiet;
  const auto actual = step(bayesian), expected = step(icp);
  for (std::size_t i = 0; i < actual->size(); ++i)
    ASSERT_EQ((*actual)[i].getVector4fMap(), (*expected)[i].getVector4fMap());
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

/** A registration by preset `exact` at the scale of the scans' noise. */
void
useExact(BayesianIcp& icp, const Scans<PointXYZ>& scans)
{
  bayesian_icp::Options options;
  options.preset = bayesian_icp::Preset::Exact;
  bayesian_icp::Vector6d spread;
  spread << 0.02, 0.02, 0.02, 0.05, 0.05, 0.05;
  options.exact.initial_spread = spread;
  icp.setOptions(options);
  icp.setMeasurementSigma(0.02);
  icp.setEffectivePoints(100.0);
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
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

TEST(Exact, GivesTheSameDrawsForEveryNumberOfThreadsAndAMeanNearTheTruth)
{
  const Scans<PointXYZ> scans;
  bayesian_icp::PoseMatrix samples[2];
  for (unsigned int num_threads = 1; num_threads <= 2; ++num_threads) {
    BayesianIcp icp;
    useExact(icp, scans);
    icp.setNumberOfThreads(num_threads);
    Cloud output;
    icp.align(output);
    EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::Ok)
        << icp.getSummary().message;
    ASSERT_EQ(icp.getSummary().modes.size(), 1u);
    samples[num_threads - 1] = icp.getSamples();
    const bayesian_icp::Vector6d error = icp.getMean() - smallPose();
    for (int k = 0; k < 6; ++k)
      EXPECT_LT(std::abs(error[k]), 4.0 * std::sqrt(icp.getCovariance()(k, k)));
  }
  EXPECT_EQ(samples[0].rows(), 2000);
  EXPECT_EQ(samples[0], samples[1]);
}

/** PCL's tree, but not its class: a search of the user's own. */
class UsersTree : public search::KdTree<PointXYZ> {};

TEST(Exact, AUsersTreeGivesTheSamePosterior)
{
  const Scans<PointXYZ> scans;
  bayesian_icp::Summary summaries[2];
  for (int i = 0; i < 2; ++i) {
    BayesianIcp icp;
    useExact(icp, scans);
    icp.setNumberOfSamples(800);
    if (i == 1)
      icp.setSearchMethodTarget(pcl::make_shared<UsersTree>());
    const QuietConsole quiet;
    Cloud output;
    icp.align(output);
    summaries[i] = icp.getSummary();
    ASSERT_EQ(icp.getSamples().rows(), 800);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    const auto &a = summaries[0].coordinates[k], &b = summaries[1].coordinates[k];
    EXPECT_NEAR(a.mean, b.mean, 5.0 * std::hypot(a.mcse, b.mcse)) << k;
    EXPECT_NEAR(std::log(a.standard_deviation / b.standard_deviation), 0.0, 0.2) << k;
  }
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
  Exposed<BayesianIcp> with_holes;
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

TEST(BadInput, NaNTargetPointsAreIgnored)
{
  Scans<PointXYZ> scans;
  (*scans.target)[3].x = nan_value;
  scans.target->is_dense = false;
  BayesianIcp icp;
  alignQuietly(scans, icp);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_TRUE(icp.getSamples().allFinite());
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

TEST(BadInput, CloudsWithoutOverlapFail)
{
  const Scans<PointXYZ> scans;
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(0, 3) = 100.0f;
  expectFailure(scans.source, scans.target, guess, 0.1);
}

TEST(BadInput, AllNaNSourceFails)
{
  const Scans<PointXYZ> scans;
  expectFailure(cloudOf(std::vector<PointXYZ>(10, PointXYZ(nan_value, 0, 0))),
                scans.target,
                Eigen::Matrix4f::Identity(),
                1.0);
}

TEST(BadInput, AllNaNTargetFails)
{
  const Scans<PointXYZ> scans;
  expectFailure(scans.source,
                cloudOf(std::vector<PointXYZ>(10, PointXYZ(0, 0, nan_value))),
                Eigen::Matrix4f::Identity(),
                1.0);
}

TEST(BadInput, TwoSourcePointsFail)
{
  const Scans<PointXYZ> scans;
  expectFailure(cloudOf({PointXYZ(0, 0, 0), PointXYZ(1, 0, 0)}),
                scans.target,
                Eigen::Matrix4f::Identity(),
                10.0);
}

TEST(BadInput, NonFiniteGuessFails)
{
  const Scans<PointXYZ> scans;
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(1, 1) = nan_value;
  expectFailure(scans.source, scans.target, guess, 10.0);
}

TEST(BadInput, GuessTooFarForFloatDistancesFails)
{
  const Scans<PointXYZ> scans;
  for (const float x : {1e30f, 3e38f}) {
    Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
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

TEST(BadInput, DegenerateCloudsDoNotCrash)
{
  const QuietConsole quiet;
  const auto equal = cloudOf(std::vector<PointXYZ>(50, PointXYZ(1, 2, 3)));
  std::vector<PointXYZ> line(50, PointXYZ(0, 0, 0));
  for (std::size_t i = 0; i < line.size(); ++i)
    line[i].x = 0.01f * static_cast<float>(i);
  std::vector<PointXYZ> far(50, PointXYZ(1e6f, -1e6f, 1e6f));
  const Cloud::Ptr clouds[] = {
      equal, cloudOf(line), cloudOf(far), bumpySurface<PointXYZ>(3, 4)};
  for (const auto& source : clouds)
    for (const auto& target : clouds) {
      BayesianIcp icp;
      useFewSamples(icp);
      icp.setInputSource(source);
      icp.setInputTarget(target);
      Cloud output;
      icp.align(output);
      EXPECT_EQ(output.size(), source->size());
      EXPECT_NE(icp.getSummary().status, bayesian_icp::Status::NotRun);
    }
}

} // namespace
} // namespace test
} // namespace pcl
