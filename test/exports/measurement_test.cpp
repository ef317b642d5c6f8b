// Posteriors without their prior: against draws of a known likelihood, and what becomes
// of a filter that counts its odometry once or twice.
#include "exports/some_estimate.h"
#include "geometry/twist.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/random.h>
#include <bayesian_icp/summary.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <utility>

namespace bayesian_icp {
namespace {

constexpr auto left = CovarianceConvention::LeftSE3;
constexpr auto right = CovarianceConvention::RightSE3;

const Vector6d some_pose(0.4, -0.3, 0.2, 0.2, -0.1, 0.7);

Matrix6d
informationAt(const PoseEstimate& estimate, CovarianceConvention convention)
{
  return estimate.covariance(convention).inverse();
}

/** \p num_draws of the draws, each as often as its weight says. */
PoseMatrix
resampled(const PoseMatrix& draws, const Eigen::VectorXd& weights, Random& random)
{
  const auto num_draws = static_cast<double>(draws.rows());
  PoseMatrix chosen(draws.rows(), 6);
  const double offset = random.uniform();
  double reached = weights[0];
  Eigen::Index from = 0;
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const double wanted = (static_cast<double>(i) + offset) / num_draws * weights.sum();
    while (reached < wanted && from + 1 < draws.rows())
      reached += weights[++from];
    chosen.row(i) = draws.row(from);
  }
  return chosen;
}

TEST(WithoutPrior, GivesTheLikelihoodBack)
{
  // A likelihood that is Gaussian in the source frame, and a prior hardly wider.
  Random random(1, 0);
  Matrix6d factor = 0.01 * Matrix6d::Identity();
  factor(1, 5) = 0.005;
  factor(2, 3) = -0.004;
  Vector6d prior_mean = some_pose;
  prior_mean += Vector6d(0.01, -0.015, 0.01, 0.012, 0.0, -0.01);
  const Prior prior(prior_mean, Vector6d::Constant(0.015 * 0.015), {0.3, -0.2, 0.5});

  constexpr Eigen::Index num_draws = 40000;
  PoseMatrix draws(num_draws, 6);
  Eigen::VectorXd weights(num_draws);
  for (Eigen::Index i = 0; i < num_draws; ++i) {
    const Vector6d pose = poseFromError(factor * random.normal6(), some_pose, right);
    draws.row(i) = pose.transpose();
    weights[i] = std::exp(-prior.energy(pose));
  }
  // Resampling doubles the variance of what is computed at most.
  const double ess = std::pow(weights.sum(), 2) / weights.squaredNorm() / 2.0;
  ASSERT_GT(ess, 1000.0);
  const PoseMatrix resampled_draws = resampled(draws, weights, random);
  const PoseEstimate posterior =
      test::estimateOf(resampled_draws, meanPose(resampled_draws));
  const PoseMeasurement measurement = withoutPrior(posterior, prior);
  EXPECT_EQ(measurement.num_unmeasured, 0);

  // A relative error of e = 1 / (1 + lambda) is one 1 / (1 - e) times as large of
  // 1 / lambda; here e < 0.8^2, or there were
  // unmeasured directions.
  const double amplification = 1.0 / (1.0 - 0.8 * 0.8);
  const Matrix6d inverse_factor = factor.inverse();
  const Matrix6d relative = inverse_factor * measurement.estimate.covariance(right) *
                            inverse_factor.transpose();
  EXPECT_LT((relative - Matrix6d::Identity()).cwiseAbs().maxCoeff(),
            5.0 * amplification * std::sqrt(2.0 / ess));
  const Vector6d error =
      inverse_factor * poseError(measurement.estimate.mean, some_pose, right);
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 5.0 * amplification / std::sqrt(ess));
  // It had something to do: the posterior is narrower and elsewhere.
  const Vector6d shift = inverse_factor * poseError(posterior.mean, some_pose, right);
  EXPECT_GT(shift.cwiseAbs().maxCoeff(), 5.0 * amplification / std::sqrt(ess));
}

TEST(WithoutPrior, SaysWhereTheCloudsSayNothing)
{
  // min_ess draws of the prior itself.
  const Vector6d deviation(0.02, 0.02, 0.02, 0.01, 0.01, 0.03);
  const Prior prior(some_pose, deviation.cwiseAbs2());
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Random random(seed, 0);
    PoseMatrix draws(static_cast<Eigen::Index>(min_ess), 6);
    for (Eigen::Index i = 0; i < draws.rows(); ++i)
      draws.row(i) = some_pose + deviation.cwiseProduct(random.normal6());
    const PoseEstimate posterior = test::estimateOf(draws, meanPose(draws));
    EXPECT_EQ(withoutPrior(posterior, prior).num_unmeasured, 6) << seed;
  }
}

TEST(WithoutPrior, DeviationsOfMeasuredMotionsStayNearThePosteriors)
{
  // A planar scan: the clouds hold x, y and yaw, the prior alone the rest.
  const Vector6d deviation(0.001, 0.0005, 0.02, 0.005, 0.005, 0.0002);
  const Prior prior(Vector6d::Zero(),
                    Vector6d(0.02, 0.02, 0.02, 0.005, 0.005, 0.005).cwiseAbs2());
  constexpr Eigen::Index num_draws = 1500;
  // Each of three unmeasured directions adds unmeasured_deviation^2 times the square of
  // its chance correlation, of mean 1 / num_draws, to the relative variance of each of
  // three measured ones.
  constexpr int num_runs = 100;
  const double added = unmeasured_deviation * unmeasured_deviation / num_draws;
  double sum = 0.0;
  for (std::uint64_t seed = 0; seed < num_runs; ++seed) {
    Random random(seed, 1);
    PoseMatrix draws(num_draws, 6);
    for (Eigen::Index i = 0; i < num_draws; ++i)
      draws.row(i) = deviation.cwiseProduct(random.normal6());
    const PoseEstimate posterior = test::estimateOf(draws, meanPose(draws));
    const PoseMeasurement measurement = withoutPrior(posterior, prior);
    ASSERT_EQ(measurement.num_unmeasured, 3) << seed;
    for (const int k : {0, 1, 5})
      sum += measurement.estimate.covariance(left)(k, k) /
             posterior.covariance(left)(k, k);
  }
  // A chi-square of three degrees of freedom has the variance 6; the three motions of a
  // run have unmeasured draws in common, so they may count as one.
  const double deviation_of_mean = added * std::sqrt(6.0 / num_runs);
  EXPECT_NEAR(sum / (3.0 * num_runs), 1.0 + 3.0 * added, 5.0 * deviation_of_mean);
  EXPECT_LT(std::sqrt(1.0 + 3.0 * added), 1.1);
}

TEST(WithoutPrior, NaNWithoutAPosterior)
{
  const PoseMeasurement measurement =
      withoutPrior(PoseEstimate(), Prior(some_pose, Vector6d::Ones()));
  EXPECT_TRUE(measurement.estimate.mean.array().isNaN().all());
  EXPECT_TRUE(measurement.estimate.covariance(left).array().isNaN().all());
  EXPECT_EQ(measurement.num_unmeasured, 6);
}

TEST(WithoutPrior, APriorThatIsNotFiniteIsAnInvalidInput)
{
  PoseEstimate posterior;
  posterior.status = Status::Ok;
  posterior.mean = some_pose;
  posterior.covariances.fill(1e-4 * Matrix6d::Identity());
  const Vector6d ones = Vector6d::Ones();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(withoutPrior(posterior, Prior(some_pose, ones)).estimate.status,
            Status::Ok);
  for (const Prior& prior : {Prior(PriorOptions().mean, ones),
                             Prior(some_pose, nan * ones),
                             Prior(some_pose, 0.0 * ones),
                             Prior(some_pose, ones, {0.0, nan, 0.0})}) {
    const PoseEstimate estimate = withoutPrior(posterior, prior).estimate;
    EXPECT_EQ(estimate.status, Status::InvalidInput);
    EXPECT_TRUE(estimate.mean.array().isNaN().all());
    EXPECT_TRUE(estimate.covariance(left).array().isNaN().all());
    EXPECT_EQ(estimateOf(prior).status, Status::InvalidInput);
  }
  EXPECT_EQ(estimateOf(Prior(some_pose, ones)).status, Status::Ok);
  posterior.mean[0] = nan;
  EXPECT_EQ(withoutPrior(posterior, Prior(some_pose, ones)).estimate.status,
            Status::InvalidInput);
}

TEST(WithoutPrior, ACovarianceWithANegativeEigenvalueIsAnInvalidInput)
{
  Matrix6d covariance = 1e-4 * Matrix6d::Identity();
  covariance(0, 1) = covariance(1, 0) = 2e-4;
  PoseEstimate posterior =
      estimateOf(some_pose, covariance, CovarianceConvention::RightSE3);
  posterior.status = Status::Ok;
  const Prior prior(some_pose, Vector6d::Ones());
  EXPECT_EQ(withoutPrior(posterior, prior).estimate.status, Status::InvalidInput);
}

TEST(WithoutPrior, AnInfinitePriorChangesNothing)
{
  const PoseEstimate posterior =
      estimateOf(some_pose, 1e-4 * Matrix6d::Identity(), left);
  const double infinite = std::numeric_limits<double>::infinity();
  const PoseMeasurement measurement =
      withoutPrior(posterior, Prior(Vector6d::Zero(), Vector6d::Constant(infinite)));
  EXPECT_EQ(measurement.num_unmeasured, 0);
  EXPECT_LT((measurement.estimate.mean - some_pose).norm(), 1e-8);
  EXPECT_TRUE(measurement.estimate.covariance(left).isApprox(
      1e-4 * Matrix6d::Identity(), 1e-6));
}

TEST(WithoutPrior, IsTheSameWhereverTheTargetsFrameIs)
{
  // As in UTM coordinates, which are kept to a nanometre.
  const Matrix6d covariance = test::someCovariance(1e-4);
  const Vector6d variance = Vector6d::Constant(4e-8);
  const Eigen::Vector3d point(0.3, -0.2, 0.5);
  const auto at = [&](const Vector6d& pose) {
    Vector6d prior_mean = pose;
    prior_mean[0] += 1e-4;
    const Prior prior(prior_mean, variance, point);
    return std::pair(withoutPrior(estimateOf(pose, covariance, right), prior),
                     estimateOf(prior));
  };
  Vector6d far = some_pose;
  far.head<3>() += Eigen::Vector3d(5e5, 5e6, 100.0);
  const auto [measurement, prior] = at(some_pose);
  const auto [far_measurement, far_prior] = at(far);
  EXPECT_EQ(far_measurement.num_unmeasured, measurement.num_unmeasured);
  EXPECT_LT(test::relativeDifference(far_measurement.estimate.covariance(right),
                                     measurement.estimate.covariance(right)),
            1e-4);
  EXPECT_LT(
      test::relativeDifference(far_prior.covariance(right), prior.covariance(right)),
      1e-6);
  const Vector6d shift = poseError(measurement.estimate.mean, some_pose, right);
  const Vector6d far_shift = poseError(far_measurement.estimate.mean, far, right);
  EXPECT_LT((far_shift - shift).norm(), 1e-8);
}

TEST(Estimate, IsTheSameForBothTriplesOfAnglesOfARotation)
{
  const Vector6d variance =
      (Vector6d() << 0.01, 0.02, 0.03, 1e-4, 4e-4, 9e-4).finished();
  for (const double pitch : {0.3, 1.3, 1.5}) {
    Vector6d mean, other;
    mean << 1.0, 2.0, 3.0, 0.2, pitch, -0.4;
    other << 1.0, 2.0, 3.0, 0.2 + M_PI, M_PI - pitch, -0.4 + M_PI;
    const PoseEstimate estimate = estimateOf(Prior(mean, variance));
    const PoseEstimate same = estimateOf(Prior(other, variance));
    for (const auto convention : covariance_conventions) {
      const Matrix6d& expected = estimate.covariance(convention);
      EXPECT_LT((same.covariance(convention).diagonal() - expected.diagonal())
                    .cwiseAbs()
                    .maxCoeff(),
                1e-9);
    }
    const Matrix6d& of_angles = same.covariance(CovarianceConvention::Parameters);
    EXPECT_LT((of_angles - Matrix6d(variance.asDiagonal())).cwiseAbs().maxCoeff(),
              1e-9);
  }
}

TEST(Estimate, InOtherConventionsIsThatOfTheAdjoint)
{
  Vector6d far = some_pose;
  far.head<3>() += Eigen::Vector3d(1e5, 1e5, 0.0);
  for (const Vector6d& pose : {some_pose, far}) {
    const Matrix6d covariance = test::someCovariance(1e-3);
    const Eigen::Matrix4d T = matrixOf(pose);
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    Matrix6d adjoint;
    adjoint << R, crossMatrix(T.topRightCorner<3, 1>()) * R, Eigen::Matrix3d::Zero(), R;
    const Matrix6d of_left = adjoint * covariance * adjoint.transpose();
    EXPECT_LT(test::relativeDifference(
                  estimateOf(pose, covariance, right).covariance(left), of_left),
              1e-9);
    EXPECT_LT(test::relativeDifference(
                  estimateOf(pose, of_left, left).covariance(right), covariance),
              1e-2);
  }
}

/** A robot above a table: odometry N(0, 1 / odometry) about some_pose, and clouds that
 * see height, roll and pitch only. Left twists; small, so that they add up. */
class FilterWithOdometry : public testing::Test {
protected:
  FilterWithOdometry()
  : prior_(some_pose, Vector6d::Constant(0.01 * 0.01))
  , odometry_(
        twistPrior(prior_, isometryOf(some_pose), Eigen::Vector3d::Zero()).precision)
  {
    clouds_.setZero();
    clouds_.diagonal() << 0.0, 0.0, 1.0, 1.0, 1.0, 0.0;
    clouds_ *= 1.0 / (0.002 * 0.002);
    odometry_factor_ = odometry_.inverse().llt().matrixL();
    posterior_information_ = odometry_ + clouds_;
  }

  /** What the filter believes: error about some_pose, and information. */
  struct Belief {
    Vector6d mean;
    Matrix6d information;
  };

  Vector6d
  drawTruth(Random& random) const
  {
    return odometry_factor_ * random.normal6();
  }

  /** The posterior with the odometry as its prior. */
  PoseEstimate
  registered(const Vector6d& truth, Random& random) const
  {
    const Vector6d seen = truth + 0.002 * random.normal6();
    const Vector6d mean = posterior_information_.inverse() * (clouds_ * seen);
    PoseEstimate posterior = estimateOf(
        poseFromError(mean, some_pose, left), posterior_information_.inverse(), left);
    posterior.status = Status::Ok;
    return posterior;
  }

  Belief
  fusedWithOdometry(const PoseEstimate& measurement) const
  {
    const Matrix6d information = informationAt(measurement, left);
    const Vector6d error = poseError(measurement.mean, some_pose, left);
    const Matrix6d sum = odometry_ + information;
    return {sum.inverse() * (information * error), sum};
  }

  static double
  nees(const Belief& belief, const Vector6d& truth)
  {
    const Vector6d error = belief.mean - truth;
    return error.dot(belief.information * error);
  }

  Prior prior_;
  Matrix6d odometry_;
  Matrix6d odometry_factor_;
  Matrix6d clouds_;
  Matrix6d posterior_information_;
};

TEST_F(FilterWithOdometry, CountsItOnceWithoutThePriorAndTwiceWithIt)
{
  constexpr int num_runs = 1000;
  double once = 0.0, twice = 0.0;
  for (std::uint64_t run = 0; run < num_runs; ++run) {
    Random random(2, run);
    const Vector6d truth = drawTruth(random);
    const PoseEstimate posterior = registered(truth, random);
    const PoseMeasurement measurement = withoutPrior(posterior, prior_);
    ASSERT_EQ(measurement.num_unmeasured, 3);
    once += nees(fusedWithOdometry(measurement.estimate), truth) / num_runs;
    twice += nees(fusedWithOdometry(posterior), truth) / num_runs;
  }
  // The mean of so many chi-squares of six degrees of freedom, variance 12.
  const double tolerance = 5.0 * std::sqrt(12.0 / num_runs);
  EXPECT_NEAR(once, 6.0, tolerance);
  // Half the variance in the three directions that only the odometry knows: twice a
  // chi-square of three, and one of three.
  EXPECT_NEAR(twice, 9.0, 5.0 * std::sqrt(30.0 / num_runs));
}

TEST_F(FilterWithOdometry, FusedAgainItIsThePosterior)
{
  Random random(3, 0);
  const PoseEstimate posterior = registered(drawTruth(random), random);
  const Belief belief = fusedWithOdometry(withoutPrior(posterior, prior_).estimate);
  const Vector6d difference = belief.mean - poseError(posterior.mean, some_pose, left);
  // In standard deviations. What is not exact: unmeasured_deviation is not infinite,
  // and twists of 0.01 do not quite add up.
  const double distance =
      std::sqrt(difference.dot(posterior_information_ * difference));
  EXPECT_LT(distance, 0.05);
  const Matrix6d ratio = posterior_information_.inverse() * belief.information;
  EXPECT_LT((ratio - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 0.05);
}

} // namespace
} // namespace bayesian_icp
