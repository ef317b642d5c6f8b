// GTSAM reads our exports: its marginals and its coordinates of the draws are ours.
#include "exports/some_estimate.h"

#include <gtest/gtest.h>

#include <gtsam/config.h>
#include <gtsam/geometry/Pose3.h>
#include <gtsam/nonlinear/Marginals.h>
#include <gtsam/nonlinear/NonlinearFactorGraph.h>
#include <gtsam/nonlinear/Values.h>
#include <gtsam/slam/BetweenFactor.h>
#include <gtsam/slam/dataset.h>

#include <cstdio>
#include <fstream>
#include <string>

using namespace bayesian_icp;
using namespace bayesian_icp::test;

namespace {

constexpr gtsam::Key target = 4, source = 5;

/** Pose and covariance of the text for GTSAM, read as docs/exports.md does. */
struct GtsamFile {
  gtsam::Pose3 pose;
  Matrix6d covariance;

  explicit GtsamFile(const PoseEstimate& estimate)
  {
    std::istringstream text(gtsamText(estimate, {}));
    std::string numbers;
    for (std::string line; std::getline(text, line);)
      if (line[0] != '#')
        numbers += line + "\n";
    const auto values = numbersOf(numbers);
    EXPECT_EQ(values.size(), 16U + 36U + 36U);
    using Pose = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    using Covariance = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
    pose = gtsam::Pose3(Eigen::Matrix4d(Eigen::Map<const Pose>(values.data())));
    covariance = Eigen::Map<const Covariance>(values.data() + 16);
  }
};

TEST(Gtsam, MarginalsOfABetweenFactorAreTheCovarianceThatItWasGiven)
{
  const GtsamFile file(estimateOf(drawsAboutMean(0.1)));
  gtsam::NonlinearFactorGraph graph;
  // The target far more certain than the measurement.
  const gtsam::Pose3 target_pose(gtsam::Rot3::RzRyRx(0.3, -0.2, 1.0),
                                 gtsam::Point3(4.0, -2.0, 1.0));
  graph.addPrior(target, target_pose, gtsam::noiseModel::Isotropic::Sigma(6, 1e-7));
  graph.emplace_shared<gtsam::BetweenFactor<gtsam::Pose3>>(
      target,
      source,
      file.pose,
      gtsam::noiseModel::Gaussian::Covariance(file.covariance));
  gtsam::Values values;
  values.insert(target, target_pose);
  values.insert(source, target_pose * file.pose);
  const Matrix6d marginal = gtsam::Marginals(graph, values).marginalCovariance(source);
  EXPECT_LT(relativeDifference(marginal, file.covariance), 1e-8);
}

TEST(Gtsam, CovarianceIsThatOfTheDrawsInLocalCoordinates)
{
  const PoseMatrix draws = drawsAboutMean(0.02);
  const GtsamFile file(estimateOf(draws));
  Matrix6d moment = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const gtsam::Pose3 draw(matrixOf(draws.row(i).transpose()));
    const Vector6d error = file.pose.localCoordinates(draw);
    moment += error * error.transpose();
  }
  moment /= static_cast<double>(draws.rows() - 1);
  // Translation and rotation apart, as GTSAM may be built, differ in second order.
#ifdef GTSAM_POSE3_EXPMAP
  constexpr double tolerance = 1e-9;
#else
  constexpr double tolerance = 1e-3;
#endif
  EXPECT_LT(relativeDifference(file.covariance, moment), tolerance);
  // Translation first is far off.
  const Matrix6d translation_first =
      estimateOf(draws).covariance(CovarianceConvention::RightSE3);
  EXPECT_GT(relativeDifference(translation_first, moment), 0.1);
}

TEST(Gtsam, ReaderOfG2oTakesHalfAnglesForAngles)
{
  const PoseEstimate estimate = estimateOf(drawsAboutMean(0.01));
  const GtsamFile file(estimate);
  ExportOptions options;
  options.target_vertex = target;
  options.source_vertex = source;
  const std::string name = ::testing::TempDir() + "bayesian_icp_gtsam_test.g2o";
  std::ofstream(name) << g2oVertex(Eigen::Matrix4d::Identity(), target)
                      << g2oVertex(matrixOf(estimate.mean), source)
                      << g2oEdge(estimate, options);
  const auto graph = gtsam::readG2o(name, true).first;
  std::remove(name.c_str());
  ASSERT_EQ(graph->size(), 1U);
  using Between = gtsam::BetweenFactor<gtsam::Pose3>;
  const auto edge = dynamic_cast<const Between*>(graph->at(0).get());
  ASSERT_NE(edge, nullptr);
  EXPECT_TRUE(edge->measured().equals(file.pose, 1e-9));
  const auto noise =
      dynamic_cast<const gtsam::noiseModel::Gaussian*>(edge->noiseModel().get());
  ASSERT_NE(noise, nullptr);
  // What docs/exports.md warns of: half the deviation of each angle.
  const Vector6d half_angles(0.5, 0.5, 0.5, 1.0, 1.0, 1.0);
  const Matrix6d expected =
      half_angles.asDiagonal() * file.covariance * half_angles.asDiagonal();
  EXPECT_LT(relativeDifference(noise->covariance(), expected), 1e-8);
}

} // namespace
