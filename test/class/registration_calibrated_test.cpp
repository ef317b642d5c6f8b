// Preset `calibrated` in the PCL class: what it finds, and whose points it looks at.
#include "support/registration_support.h"

#include <pcl/registration/correspondence_rejection_one_to_one.h>

#include <functional>

namespace pcl::test {
namespace {

/** Dense enough for a surface. */
class CalibratedTest : public ::testing::Test {
protected:
  CalibratedTest()
  {
    transformPointCloud(
        *target, *target, bayesian_icp::matrixOf(smallPose()).cast<float>().eval());
    icp.setInputSource(source);
    icp.setInputTarget(target);
  }

  Cloud::Ptr source = bumpySurface<PointXYZ>(1, 1500);
  Cloud::Ptr target = bumpySurface<PointXYZ>(2, 8000);
  BayesianIcp icp;
  Cloud output;
  QuietConsole quiet;
};

TEST_F(CalibratedTest, RejectorsReciprocityAndTheGateAreForIcpAlone)
{
  icp.align(output);
  const auto expected = icp.getSamples();
  const Eigen::Matrix4f plain = icp.getFinalTransformation();
  icp.addCorrespondenceRejector(
      pcl::make_shared<registration::CorrespondenceRejectorOneToOne>());
  icp.setUseReciprocalCorrespondences(true);
  icp.setMaxCorrespondenceDistance(0.1);
  console::setVerbosityLevel(console::L_WARN);
  testing::internal::CaptureStderr();
  icp.align(output);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("Rejectors"),
            std::string::npos);
  EXPECT_NE(icp.getFinalTransformation(), plain);
  EXPECT_EQ(icp.getSamples(), expected);
}

TEST_F(CalibratedTest, TheMeanCanBeTheFinalTransformationInPlaceOfIcp)
{
  icp.align(output);
  const auto expected = icp.getSamples();
  int num_iterations = 0;
  std::function<BayesianIcp::UpdateVisualizerCallbackSignature> count =
      [&](const Cloud&, const Indices&, const Cloud&, const Indices&) {
        ++num_iterations;
      };
  icp.registerVisualizationCallback(count);
  num_iterations = 0;
  icp.setUseMeanAsFinalTransformation(true);
  icp.align(output);
  EXPECT_EQ(num_iterations, 0);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getSamples(), expected);
  EXPECT_EQ(icp.getFinalTransformation(), icp.getMeanTransformation());
  expectMoved(output, *source, icp.getMeanTransformation());
}

TEST_F(CalibratedTest, IcpRunsWhereThereIsNoUsableMean)
{
  icp.setPrior(bayesian_icp::Vector6d::Zero(), bayesian_icp::Vector6d::Constant(-1.0));
  icp.align(output);
  const Eigen::Matrix4f expected = icp.getFinalTransformation();
  ASSERT_TRUE(icp.hasConverged());
  icp.setUseMeanAsFinalTransformation(true);
  icp.align(output);
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::InvalidOptions);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getFinalTransformation(), expected);
}

TEST_F(CalibratedTest, WithTheMeanACancelledRunStaysAtTheGuess)
{
  icp.setUseMeanAsFinalTransformation(true);
  icp.setProgressCallback([](const bayesian_icp::Progress&) { return (false); });
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess(0, 3) = 0.01f;
  icp.align(output, guess);
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::Cancelled);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getFinalTransformation(), guess);
  EXPECT_NEAR(output[5].x, (*source)[5].x + 0.01f, 1e-6f);
}

TEST_F(CalibratedTest, CancellingEndsIcpAfterTheIteration)
{
  int num_calls = 0;
  icp.setProgressCallback([&](const bayesian_icp::Progress& progress) {
    EXPECT_EQ(progress.steps, 0u);
    ++num_calls;
    return (false);
  });
  icp.setMaximumIterations(50);
  icp.setTransformationEpsilon(0.0);
  icp.align(output);
  EXPECT_EQ(num_calls, 1);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::Cancelled);
  EXPECT_EQ(icp.getSamples().rows(), 0);
}

TEST_F(CalibratedTest, AnObjectThatKeepsItsCloudsGivesWhatANewOneGives)
{
  icp.align(output);
  const Cloud::Ptr other_source = bumpySurface<PointXYZ>(3, 1200);
  const Cloud::Ptr other_target = bumpySurface<PointXYZ>(4, 7000);
  const auto expectAsNew = [&](const Cloud::Ptr& cloud, const Cloud::Ptr& to) {
    BayesianIcp fresh;
    aligned(fresh, cloud, to);
    const Eigen::Matrix4f expected = fresh.getFinalTransformation();
    icp.align(output);
    EXPECT_EQ(icp.getSamples(), fresh.getSamples());
    EXPECT_EQ(icp.getFinalTransformation(), expected);
  };
  icp.setInputSource(other_source);
  expectAsNew(other_source, target);
  icp.setInputTarget(other_target);
  expectAsNew(other_source, other_target);
  // The same cloud with other points.
  for (auto& point : *other_target)
    point.x += 0.01f;
  icp.setInputTarget(other_target);
  expectAsNew(other_source, other_target);
  // The source becomes the target, as in odometry; the other way around; and a target
  // with a point that is not finite, which was a source without it.
  icp.setInputTarget(other_source);
  icp.setInputSource(source);
  expectAsNew(source, other_source);
  icp.setInputTarget(source);
  icp.setInputSource(other_source);
  expectAsNew(other_source, source);
  const Cloud::Ptr holed(new Cloud(*other_source));
  holed->emplace_back(std::nanf(""), 0.f, 0.f);
  holed->is_dense = false;
  icp.setInputTarget(holed);
  icp.setInputSource(source);
  expectAsNew(source, holed);
}

} // namespace
} // namespace pcl::test
