// pcl::BayesianIterativeClosestPoint: the posterior on top of PCL's registration.
#include "support/registration_support.h"

namespace pcl::test {
namespace {

class Posterior : public ScansTest {
protected:
  Posterior() { useFewSamples(icp); }

  BayesianIcp icp;
};

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
  const QuietConsole quiet;
  const auto output = aligned(icp, scans.source, scans.target);
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
  aligned(icp, scans.source, scans.target);
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

TEST_F(Posterior, IsEmptyBeforeAlign)
{
  EXPECT_EQ(icp.getClassName(), "BayesianIterativeClosestPoint");
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

TEST_F(Posterior, HasTheDrawsThatWereAskedFor)
{
  icp.setNumberOfSamples(103);
  icp.setNumberOfChains(4);
  align(icp);
  ASSERT_EQ(icp.getSamples().rows(), 103);
  EXPECT_EQ(icp.getChain(0).rows(), 26);
  EXPECT_EQ(icp.getChain(3).rows(), 25);
  EXPECT_EQ(icp.getChain(4).rows(), 0);
  EXPECT_EQ(icp.getSamples().topRows(26), icp.getChain(0));
  EXPECT_EQ(icp.getSummary().num_draws, 103);
}

TEST_F(Posterior, TellsWhichOfItsChainsDiverged)
{
  usePaper(icp);
  auto options = icp.getOptions();
  options.paper.sgld.step_size = 4e-4;
  do { // until the first of them run away
    options.paper.sgld.step_size *= 1.1;
    icp.setOptions(options);
    align(icp);
  }
  while (icp.getSummary().num_diverged_chains == 0 &&
         options.paper.sgld.step_size < 1.0);
  int num_diverged = 0;
  Eigen::Index num_draws = 0;
  for (std::size_t chain = 0; chain < 5; ++chain) { // of which the last is none
    num_diverged += icp.hasChainDiverged(chain) ? 1 : 0;
    num_draws += icp.hasChainDiverged(chain) ? 0 : icp.getChain(chain).rows();
  }
  EXPECT_EQ(num_diverged, icp.getSummary().num_diverged_chains);
  EXPECT_EQ(num_draws, icp.getSamples().rows());
  EXPECT_GT(num_draws, 0);
}

/** For other numbers of threads and larger clouds see determinism_large_test.cpp. */
TEST_F(Posterior, IsRepeatableAndThatOfItsSeed)
{
  align(icp);
  const auto expected = icp.getSamples();
  icp.setSeed(2);
  align(icp);
  EXPECT_NE(icp.getSamples(), expected);
  icp.setSeed(1);
  icp.setNumberOfThreads(0); // as many as there are
  align(icp);
  EXPECT_EQ(icp.getSamples(), expected);
}

TEST_F(Posterior, OfPresetCalibratedRefusesAScale)
{
  icp.setMeasurementSigma(1.0); // the default, and yet stated
  align(icp);
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidOptions);
  EXPECT_NE(icp.getSummary().message.find("setMeasurementSigma"), std::string::npos);
  EXPECT_NE(icp.getSummary().message.find("setOptions(getOptions())"),
            std::string::npos);
  EXPECT_EQ(icp.getSamples().rows(), 0);
  EXPECT_TRUE(icp.hasConverged());
  icp.setOptions(icp.getOptions());
  align(icp);
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

TEST_F(Posterior, HasThePriorThatWasSampledWith)
{
  EXPECT_TRUE(icp.getPrior().mean().array().isNaN().all());
  align(icp, bayesian_icp::matrixOf(smallPose()).cast<float>());
  EXPECT_LT((icp.getPrior().mean() - smallPose()).norm(), 1e-6);
  EXPECT_EQ(icp.getPrior().referencePoint(), Eigen::Vector3d::Zero());
  icp.setPrior(2.0 * smallPose(), bayesian_icp::Vector6d::Constant(0.02));
  icp.setPriorFrame(bayesian_icp::PriorFrame::SourceCentroid);
  align(icp);
  EXPECT_EQ(icp.getPrior().mean(), 2.0 * smallPose());
  EXPECT_EQ(icp.getPrior().variance(), bayesian_icp::Vector6d::Constant(0.02));
  const Eigen::Matrix3Xd points = scans.source->getMatrixXfMap(3, 4, 0).cast<double>();
  EXPECT_LT((icp.getPrior().referencePoint() - points.rowwise().mean()).norm(), 1e-12);
  icp.setNumberOfSamples(0);
  align(icp);
  EXPECT_TRUE(icp.getPrior().mean().array().isNaN().all());
}

TEST_F(Posterior, OfPresetPaperHasAGateThatIsTheSmallerOfItsOwnAndPcls)
{
  usePaper(icp);
  icp.setMaximumIterations(1);
  const auto draws = [&](double gate, double pcl_gate) {
    auto options = icp.getOptions();
    options.paper.sgld.step_size = 1e-7;
    options.paper.max_distance = gate;
    icp.setOptions(options);
    icp.setMaxCorrespondenceDistance(pcl_gate);
    align(icp);
    return (icp.getSamples());
  };
  const auto gated = draws(0.03, 100.0);
  EXPECT_EQ(gated, draws(100.0, 0.03));
  EXPECT_NE(gated, draws(100.0, 100.0));
}

TEST_F(Posterior, CanBeCancelledAndTheObjectUsedAgain)
{
  icp.setProgressCallback(
      [](const bayesian_icp::Progress& p) { return (p.steps < 10); });
  align(icp);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::Cancelled);
  icp.setProgressCallback(nullptr);
  align(icp);
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

TEST_F(Posterior, DoesNotDependOnHowTargetPointsAreTooFar)
{
  Eigen::Matrix4f results[2];
  const float coordinates[2] = {nan_value, std::numeric_limits<float>::max()};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 40; ++k) // more than a leaf of PCL's tree has
      (*scans.target)[k].x = coordinates[i] * (1.0f - 0.01f * static_cast<float>(k));
    align(icp);
    EXPECT_TRUE(icp.getSamples().allFinite());
    results[i] = icp.getFinalTransformation();
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(Posterior, IsEmptyForAGuessThatIsNotRigid)
{
  Eigen::Matrix4f scaled = Eigen::Matrix4f::Identity(), mirrored = scaled;
  Eigen::Matrix4f projective = scaled;
  projective(3, 0) = 0.1f;
  scaled.topLeftCorner<3, 3>() *= 0.9f;
  mirrored(2, 2) = -1.0f;
  for (const auto& guess : {scaled, mirrored, projective}) {
    align(icp, guess);
    EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidInput);
    EXPECT_EQ(icp.getSamples().rows(), 0);
  }
}

TEST_F(Posterior, IsEmptyForAGuessBeyondTheRangeOfFloat)
{
  BayesianIterativeClosestPoint<PointXYZ, PointXYZ, double> in_double;
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  guess(0, 3) = 1e300;
  output = aligned(in_double, scans.source, scans.target, guess);
  EXPECT_FALSE(in_double.hasConverged());
  EXPECT_EQ(in_double.getSummary().status, bayesian_icp::Status::InvalidInput);
  EXPECT_EQ(output[0].getVector3fMap(), (*scans.source)[0].getVector3fMap());
}

} // namespace
} // namespace pcl::test
