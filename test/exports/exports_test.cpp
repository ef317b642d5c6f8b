// Exports against draws that are moved through each target's own coordinates, written
// here a second time with quaternions; their text is read back by test/cli/.
#include "exports/some_estimate.h"
#include "support/test_support.h"

#include <bayesian_icp/exports.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <functional>

using namespace bayesian_icp;
using namespace bayesian_icp::test;

namespace {

using Error = std::function<Vector6d(const Eigen::Isometry3d& mean,
                                     const Eigen::Isometry3d& draw)>;

Matrix6d
momentOf(const PoseMatrix& draws, const Error& error)
{
  const Eigen::Isometry3d mean(matrixOf(meanPoseOfTests()));
  Matrix6d moment = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const Eigen::Isometry3d draw(matrixOf(draws.row(i).transpose()));
    const Vector6d e = error(mean, draw);
    moment += e * e.transpose();
  }
  return moment / static_cast<double>(draws.rows() - 1);
}

/** g2o's toVectorMQT of inverse measurement times estimate. */
Vector6d
g2oError(const Eigen::Isometry3d& mean, const Eigen::Isometry3d& draw)
{
  const Eigen::Isometry3d delta = mean.inverse() * draw;
  const Eigen::Quaterniond q(delta.linear());
  Vector6d error;
  error << delta.translation(), (q.w() < 0.0 ? -1.0 : 1.0) * q.vec();
  return error;
}

/** GTSAM's Pose3::Logmap of mean^-1 draw: rotation first. */
Vector6d
gtsamError(const Eigen::Isometry3d& mean, const Eigen::Isometry3d& draw)
{
  const Eigen::Isometry3d delta = mean.inverse() * draw;
  const Eigen::AngleAxisd rotation(delta.linear());
  const Eigen::Vector3d w = rotation.angle() * rotation.axis();
  // V of SE(3) by its series, which is not how the library has it.
  Eigen::Matrix3d V = Eigen::Matrix3d::Identity(), term = V;
  for (int k = 1; k < 20; ++k) {
    term = term * crossMatrix(w) / (k + 1.0);
    V += term;
  }
  Vector6d error;
  error << w, V.inverse() * delta.translation();
  return error;
}

/** ROS: shift in the target frame, rotation about its fixed axes. */
Vector6d
rosError(const Eigen::Isometry3d& mean, const Eigen::Isometry3d& draw)
{
  const Eigen::AngleAxisd rotation(draw.linear() * mean.linear().transpose());
  Vector6d error;
  error << draw.translation() - mean.translation(), rotation.angle() * rotation.axis();
  return error;
}

} // namespace

// The coordinates of g2o differ from half the twist by terms of second order in the
// angle, so their moments, with no odd terms for a symmetric density, by a share of
// second order: (V - I) v = w x v / 2 + ..., sin(|w|/2) = |w|/2 - |w|^3/48. Angles of
// 0.01 rad leave some 1e-4, to which the third moments of the draws add 0.01 / sqrt(n).
TEST(Exports, G2oCovarianceIsThatOfDrawsInItsCoordinates)
{
  const PoseMatrix draws = drawsAboutMean(0.01);
  const PoseEstimate estimate = estimateOf(draws);
  const Matrix6d expected = momentOf(draws, g2oError);
  const Matrix6d found =
      g2oCovariance(estimate.covariance(CovarianceConvention::RightSE3));
  EXPECT_LT(relativeDifference(found, expected), 1e-3);
  // A left perturbation, whole angles or rotation first are far off.
  EXPECT_GT(
      relativeDifference(
          g2oCovariance(estimate.covariance(CovarianceConvention::LeftSE3)), expected),
      0.1);
  EXPECT_GT(
      relativeDifference(estimate.covariance(CovarianceConvention::RightSE3), expected),
      0.1);
}

TEST(Exports, GtsamCovarianceIsThatOfDrawsInItsCoordinates)
{
  const PoseMatrix draws = drawsAboutMean(0.3);
  const PoseEstimate estimate = estimateOf(draws);
  const Matrix6d found =
      gtsamCovariance(estimate.covariance(CovarianceConvention::RightSE3));
  // The same coordinates: only rounding errors remain.
  EXPECT_LT(relativeDifference(found, momentOf(draws, gtsamError)), 1e-9);
  // And that of the Gaussian the draws were made of, up to Monte Carlo error: an entry
  // of the correlation has variance (1 + rho^2) / n, at most 2 / n; 5 deviations.
  EXPECT_LT(relativeDifference(found, gtsamCovariance(someCovariance(0.3))),
            5.0 * std::sqrt(2.0 / num_draws));
}

TEST(Exports, RosCovarianceIsThatOfDrawsInItsCoordinates)
{
  const PoseMatrix draws = drawsAboutMean(0.3);
  const PoseEstimate estimate = estimateOf(draws);
  const Matrix6d expected = momentOf(draws, rosError);
  const std::string yaml = rosYaml(estimate, {});
  const auto numbers = numbersOf(yaml.substr(yaml.find('[')));
  ASSERT_EQ(numbers.size(), 36U);
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> found(
      numbers.data());
  EXPECT_LT(relativeDifference(found, expected), 1e-9);
}

TEST(Exports, G2oInformationWeighsDrawsLikeTheirDensity)
{
  const PoseMatrix draws = drawsAboutMean(0.01);
  const auto numbers = numbersOf(g2oEdge(estimateOf(draws), {}));
  ASSERT_EQ(numbers.size(), 2U + 7U + 21U);
  Matrix6d information;
  auto next = numbers.begin() + 9;
  for (int i = 0; i < 6; ++i)
    for (int k = i; k < 6; ++k)
      information(i, k) = information(k, i) = *next++;
  // e^T I e over draws of which I is the inverse second moment is 6 but for the terms
  // of second order.
  const Matrix6d moment = momentOf(draws, g2oError);
  EXPECT_NEAR((information * moment).trace(), 6.0, 6e-3);
}

TEST(Exports, InformationIsTheInverseWhateverTheUnits)
{
  Matrix6d covariance = someCovariance(1.0);
  const Vector6d scale(1e-6, 1e3, 1.0, 1e-9, 1e-2, 1e5);
  covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Matrix6d information = informationOf(covariance);
  const Matrix6d product =
      scale.asDiagonal() * information * covariance * scale.cwiseInverse().asDiagonal();
  EXPECT_TRUE(product.isIdentity(1e-9)) << product;
  EXPECT_EQ(information, information.transpose());
}

TEST(Exports, WhatIsNotKnownIsRefused)
{
  const PoseEstimate good = estimateOf(drawsAboutMean(0.1));
  EXPECT_EQ(complaintAboutExport(good, true), "");
  EXPECT_NE(complaintAboutExport(PoseEstimate(), false), "");
  EXPECT_NE(complaintAboutExport(PoseEstimate(), false, true), "");
  const auto refused = [](const PoseEstimate& estimate, const ExportOptions& options) {
    EXPECT_THROW(g2oEdge(estimate, options), std::invalid_argument);
    EXPECT_THROW(gtsamText(estimate, options), std::invalid_argument);
  };
  PoseEstimate bad = good;
  bad.covariances[3](2, 2) = std::numeric_limits<double>::quiet_NaN();
  refused(bad, {});
  EXPECT_THROW(rosYaml(bad, {}), std::invalid_argument);

  bad = good;
  for (auto& covariance : bad.covariances) {
    covariance.col(4) = covariance.col(3);
    covariance.row(4) = covariance.row(3);
  }
  refused(bad, {});
  EXPECT_NO_THROW(rosYaml(bad, {})) << "a covariance may be singular";

  bad = good;
  bad.covariances[3](0, 1) += bad.covariances[3](0, 0);
  refused(bad, {});

  bad = good;
  for (auto& covariance : bad.covariances)
    covariance(0, 1) = covariance(1, 0) =
        2.0 * std::sqrt(covariance(0, 0) * covariance(1, 1));
  refused(bad, {});
  EXPECT_THROW(rosYaml(bad, {}), std::invalid_argument) << "a negative eigenvalue";
}

TEST(Exports, UnreliablePosteriorsNeedToBeAskedFor)
{
  PoseEstimate estimate = estimateOf(drawsAboutMean(0.1));
  ExportOptions any;
  any.accept_unreliable = true;
  for (const Status status : {Status::NotMixed,
                              Status::SeveralModes,
                              Status::Diverged,
                              Status::Cancelled,
                              Status::NotRun,
                              Status::InvalidInput}) {
    estimate.status = status;
    for (const auto& text : {g2oEdge, gtsamText, rosYaml, tumLine, csvText}) {
      EXPECT_THROW(text(estimate, {}), std::invalid_argument) << toString(status);
      EXPECT_NO_THROW(text(estimate, any)) << toString(status);
    }
  }
  estimate.status = Status::Doubtful;
  EXPECT_NO_THROW(g2oEdge(estimate, {}));
}

TEST(Exports, QuaternionsHaveAPositiveW)
{
  // A yaw of -3 rad is half a turn the other way for Eigen.
  PoseEstimate estimate = estimateOf(drawsAboutMean(0.01));
  estimate.mean << 1.0, 2.0, 3.0, 0.3, -0.2, -3.0;
  const Eigen::Matrix3d R = rotationOf(estimate.mean);
  for (const auto& text : {tumLine, g2oEdge}) {
    const auto numbers = numbersOf(text(estimate, {}));
    const std::size_t place = text == tumLine ? 4 : 5;
    ASSERT_GT(numbers.size(), place + 3);
    const Eigen::Quaterniond q(
        numbers[place + 3], numbers[place], numbers[place + 1], numbers[place + 2]);
    EXPECT_GT(q.w(), 0.0);
    EXPECT_LT((q.toRotationMatrix() - R).norm(), 1e-12);
  }
}

TEST(Exports, BadOptionsAreRefused)
{
  const PoseEstimate estimate = estimateOf(drawsAboutMean(0.1));
  ExportOptions options;
  options.source_vertex = options.target_vertex;
  EXPECT_THROW(g2oEdge(estimate, options), std::invalid_argument);
  options.source_vertex = -1;
  EXPECT_THROW(g2oEdge(estimate, options), std::invalid_argument);
  EXPECT_THROW(g2oVertex(Eigen::Matrix4d::Identity(), -1), std::invalid_argument);
  for (const char* frame : {"", "a b", "a\"", "a\n", "a,b"}) {
    options = {};
    options.target_frame = frame;
    EXPECT_THROW(rosYaml(estimate, options), std::invalid_argument) << frame;
    EXPECT_THROW(csvText(estimate, options), std::invalid_argument) << frame;
  }
  options = {};
  for (const std::int64_t time :
       {std::int64_t(-1), (std::int64_t(1) << 31) * 1000000000}) {
    options.timestamp_ns = time;
    EXPECT_THROW(tumLine(estimate, options), std::invalid_argument) << time;
  }
  options.timestamp_ns = (std::int64_t(1) << 31) * 1000000000 - 1;
  EXPECT_EQ(tumLine(estimate, options).rfind("2147483647.999999999 ", 0), 0U);
}

TEST(Exports, StatusesReadBack)
{
  for (int i = 0; i <= static_cast<int>(Status::InvalidInput); ++i) {
    Status status = Status::NotRun;
    EXPECT_TRUE(readStatus(toString(static_cast<Status>(i)), status));
    EXPECT_EQ(static_cast<int>(status), i);
  }
  Status status = Status::Ok;
  EXPECT_FALSE(readStatus("fine", status));
  EXPECT_EQ(status, Status::Ok);
}
