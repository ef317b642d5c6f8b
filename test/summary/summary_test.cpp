// Mean, covariances, quantiles and status of draws whose distribution is known.
#include "sampler/chain_set.h"
#include "summary/estimates.h"
#include "support/test_support.h"

#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/summary.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace bayesian_icp {
namespace {

const double pi = std::acos(-1.0);

/** Draws whose error about \p mean in \p convention is N(0, covariance). */
PoseMatrix
gaussianDraws(Random& random,
              Eigen::Index num_draws,
              const Vector6d& mean,
              const Matrix6d& covariance,
              CovarianceConvention convention)
{
  const Matrix6d factor = covariance.llt().matrixL();
  PoseMatrix draws(num_draws, 6);
  for (Eigen::Index i = 0; i < num_draws; ++i)
    draws.row(i) =
        poseFromError(factor * random.normal6(), mean, convention).transpose();
  return draws;
}

Matrix6d
someCovariance(Random& random)
{
  const Matrix6d factor = 0.02 * test::randomSquare(random);
  return factor * factor.transpose() + 1e-4 * Matrix6d::Identity();
}

/** \param[in] random a Random, which may be a temporary */
template <typename Generator>
ChainSet
mixedChains(Generator&& random, int num_chains = 4, Eigen::Index num_draws = 500)
{
  ChainSet set;
  for (int c = 0; c < num_chains; ++c)
    set.chains.push_back({gaussianDraws(random,
                                        num_draws,
                                        Vector6d::Constant(0.1),
                                        1e-3 * Matrix6d::Identity(),
                                        CovarianceConvention::Parameters)});
  return set;
}

/** All draws X as A X B. */
PoseMatrix
movedDraws(const Eigen::Matrix4d& A, const PoseMatrix& draws, const Eigen::Matrix4d& B)
{
  PoseMatrix moved(draws.rows(), 6);
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    moved.row(i) = poseOf(A * matrixOf(draws.row(i).transpose()) * B).transpose();
  return moved;
}

/** A pose with its position some \p distance away [m]. */
Eigen::Matrix4d
farPose(Random& random, double distance)
{
  Vector6d pose = test::randomPose(random);
  pose.head<3>() *= distance;
  return matrixOf(pose);
}

TEST(Mean, OfAnglesIsTakenOnTheCircle)
{
  PoseMatrix draws = PoseMatrix::Zero(2, 6);
  draws(0, 5) = pi - 0.1;
  draws(1, 5) = -pi + 0.3;
  EXPECT_NEAR(meanPose(draws)[5], -pi + 0.1, 1e-12);
  EXPECT_NEAR(coordinateMeans(draws)[5], -pi + 0.1, 1e-12);
}

TEST(Mean, OfTurnsAboutAnAxisIsTheirAverageTurn)
{
  const Eigen::Vector3d centre(3.0, -2.0, 1.0);
  const auto turn = [&centre](double yaw) {
    Vector6d pose = Vector6d::Zero();
    pose[5] = yaw;
    pose.head<3>() = centre - rotationOf(pose) * centre;
    return pose;
  };
  PoseMatrix draws(3, 6);
  draws << turn(-1.4).transpose(), turn(0.2).transpose(), turn(0.3).transpose();
  EXPECT_LT((meanPose(draws) - turn(-0.3)).norm(), 1e-11);
}

TEST(Mean, IsThePoseAboutWhichTheTwistsCancel)
{
  Random random(28, 0);
  for (const double deviation : {1e-6, 0.01, 0.3}) {
    const PoseMatrix draws = gaussianDraws(random,
                                           500,
                                           test::randomPose(random),
                                           deviation * deviation * Matrix6d::Identity(),
                                           CovarianceConvention::LeftSE3);
    const Eigen::Matrix4d inverse = matrixOf(meanPose(draws)).inverse();
    Vector6d sum = Vector6d::Zero();
    for (const auto& draw : draws.rowwise())
      sum += logSE3(inverse * matrixOf(draw.transpose()));
    EXPECT_LT(sum.norm(), 500 * 1e-11 * (1.0 + deviation)) << deviation;
  }
}

TEST(Mean, IsTheSameMotionInAllFrames)
{
  Random random(29, 0);
  for (const double distance : {1.0, 1e4})
    for (const double deviation : {1e-3, 0.3}) {
      const PoseMatrix draws =
          gaussianDraws(random,
                        500,
                        test::randomPose(random),
                        deviation * deviation * Matrix6d::Identity(),
                        CovarianceConvention::RightSE3);
      const Eigen::Matrix4d A = farPose(random, distance),
                            B = farPose(random, distance);
      const Vector6d expected = poseOf(A * matrixOf(meanPose(draws)) * B);
      const Vector6d error = poseError(
          meanPose(movedDraws(A, draws, B)), expected, CovarianceConvention::R3xSO3);
      EXPECT_LT(error.tail<3>().norm(), 1e-12) << distance << ' ' << deviation;
      // Some hundred roundings.
      EXPECT_LT(error.head<3>().norm(), 1e-12 * distance)
          << distance << ' ' << deviation;
    }
}

TEST(Mean, IsWhereTheAnglesAreNot)
{
  // At gimbal lock roll and yaw are all over the place, and the rotations are not.
  Random random(30, 0);
  Vector6d truth = Vector6d::Zero();
  truth[4] = pi / 2;
  const PoseMatrix draws = gaussianDraws(
      random, 1000, truth, 1e-4 * Matrix6d::Identity(), CovarianceConvention::RightSE3);
  const Vector6d error =
      poseError(meanPose(draws), truth, CovarianceConvention::RightSE3);
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 5.0 * 0.01 / std::sqrt(1000.0));
}

TEST(Mean, OfTurnsAllAroundIsThatOfTheCoordinates)
{
  PoseMatrix draws = PoseMatrix::Constant(100, 6, 0.2);
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    draws(i, 5) = wrapAngle(0.1 + 2.0 * pi * static_cast<double>(i) / 100.0);
  EXPECT_EQ(meanPose(draws), coordinateMeans(draws));
  EXPECT_NEAR(meanPose(draws)[0], 0.2, 1e-12);
  // A few draws half a turn from the others, and many that are not quite so far off.
  for (const double yaw : {pi - 1e-9, 2.5}) {
    draws.col(5).setZero();
    draws.col(5).head(yaw < 3.0 ? 40 : 1).setConstant(yaw);
    EXPECT_EQ(meanPose(draws), coordinateMeans(draws));
  }
}

TEST(Mean, OfDrawsThatAreNoNumbersIsNone)
{
  PoseMatrix draws = PoseMatrix::Zero(5, 6);
  draws(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(meanPose(draws)[1]));
  EXPECT_TRUE(meanPose(PoseMatrix(0, 6)).array().isNaN().all());
}

TEST(Covariance, OfEachConventionIsThatOfTheDrawsMadeInIt)
{
  Random random(31, 0);
  const Eigen::Index n = 20000;
  for (const auto convention : covariance_conventions) {
    const Vector6d mean = test::randomPose(random, 0.5);
    const Matrix6d truth = someCovariance(random);
    const PoseMatrix draws = gaussianDraws(random, n, mean, truth, convention);
    const Matrix6d estimate = covarianceAbout(mean, draws, convention);
    // Standard error of an entry of a Gaussian's covariance; five of them, 84 entries.
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        EXPECT_NEAR(
            estimate(i, j),
            truth(i, j),
            5.0 * std::sqrt((truth(i, i) * truth(j, j) + truth(i, j) * truth(i, j)) /
                            static_cast<double>(n)))
            << toString(convention) << " " << i << " " << j;
  }
}

TEST(Covariance, LeftIsTheAdjointOfRight)
{
  // log(T T_mean^-1) = Ad(T_mean) log(T_mean^-1 T), exactly.
  Random random(32, 0);
  const Vector6d mean = test::randomPose(random, 0.5);
  const PoseMatrix draws = gaussianDraws(
      random, 300, mean, someCovariance(random), CovarianceConvention::RightSE3);
  Matrix6d adjoint = Matrix6d::Zero();
  const Eigen::Matrix3d R = rotationOf(mean);
  adjoint.topLeftCorner<3, 3>() = R;
  adjoint.bottomRightCorner<3, 3>() = R;
  for (int k = 0; k < 3; ++k)
    adjoint.block<3, 1>(0, 3 + k) = Eigen::Vector3d(mean.head<3>()).cross(R.col(k));
  const Matrix6d left = covarianceAbout(mean, draws, CovarianceConvention::LeftSE3);
  const Matrix6d right = covarianceAbout(mean, draws, CovarianceConvention::RightSE3);
  EXPECT_LT((left - adjoint * right * adjoint.transpose()).norm(), 1e-10 * left.norm());
}

TEST(Covariance, HoldsTheTruthFarFromTheOriginAsNearIt)
{
  Random random(41, 0);
  const Vector6d deviations(1e-4, 1e-4, 2e-4, 0.004, 0.004, 0.003);
  const Vector6d near_truth = test::randomPose(random, 0.5);
  const PoseMatrix near_draws = gaussianDraws(
      random,
      2000,
      poseFromError(deviations, near_truth, CovarianceConvention::RightSE3),
      deviations.cwiseAbs2().asDiagonal(),
      CovarianceConvention::RightSE3);
  const Eigen::Matrix4d A = farPose(random, 1e4), B = farPose(random, 1e4);
  const Vector6d far_truth = poseOf(A * matrixOf(near_truth) * B);
  const PoseMatrix far_draws = movedDraws(A, near_draws, B);
  const auto squaredError = [](const Vector6d& truth,
                               const PoseMatrix& draws,
                               CovarianceConvention convention) {
    const Vector6d mean = meanPose(draws);
    return test::squaredError(poseError(truth, mean, convention),
                              covarianceAbout(mean, draws, convention));
  };
  // A deviation along each of six axes; standard errors are 6 sqrt(2 / n) by the
  // covariance and 2 sqrt(6 / n) by the mean.
  const double expected =
      squaredError(near_truth, near_draws, CovarianceConvention::RightSE3);
  EXPECT_NEAR(expected, 6.0, 4.0 * std::sqrt((72.0 + 24.0) / 2000.0));
  // Variances of (0.004 rad 30 km)^2 and (0.1 mm)^2, 12 orders apart, leave 4 digits.
  for (const auto convention :
       {CovarianceConvention::LeftSE3, CovarianceConvention::RightSE3})
    EXPECT_NEAR(squaredError(far_truth, far_draws, convention), expected, 0.01)
        << toString(convention);
}

TEST(Covariance, IsUndefinedForFewerThanTwoDraws)
{
  for (const Eigen::Index n : {0, 1}) {
    const Matrix6d covariance = covarianceAbout(
        Vector6d::Zero(), PoseMatrix::Zero(n, 6), CovarianceConvention::Parameters);
    EXPECT_TRUE(covariance.array().isNaN().all());
  }
}

TEST(Summary, OfMixedChainsIsOkAndConsistent)
{
  const ChainSet chains = mixedChains(Random(33, 0));
  const PoseMatrix draws = pooledDraws(chains.chains);
  const Summary summary = summarize(chains);
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
  EXPECT_EQ(summary.mean, meanPose(draws));
  const Matrix6d about_coordinates =
      covarianceAbout(coordinateMeans(draws), draws, CovarianceConvention::Parameters);
  EXPECT_EQ(summary.num_draws, 2000);
  const double sd = std::sqrt(1e-3);
  for (int k = 0; k < 6; ++k) {
    const auto& c = summary.coordinates[static_cast<std::size_t>(k)];
    EXPECT_EQ(c.mean, coordinateMeans(draws)[k]);
    EXPECT_NEAR(c.mean, 0.1, 4.0 * sd / std::sqrt(2000.0));
    EXPECT_NEAR(c.standard_deviation, sd, 4.0 * sd / std::sqrt(4000.0));
    // Standard error of a quantile: sqrt(p (1 - p) / n) / density.
    EXPECT_NEAR(
        c.quantile_2_5, 0.1 - 1.959964 * sd, 4.0 * sd * 2.67 / std::sqrt(2000.0));
    EXPECT_NEAR(
        c.quantile_97_5, 0.1 + 1.959964 * sd, 4.0 * sd * 2.67 / std::sqrt(2000.0));
    EXPECT_NEAR(c.median, 0.1, 4.0 * sd * 1.2533 / std::sqrt(2000.0));
    EXPECT_DOUBLE_EQ(c.standard_deviation * c.standard_deviation,
                     about_coordinates(k, k));
  }
}

TEST(Summary, IsTheSameOnBothSidesOfTheAnglesCut)
{
  ChainSet chains = mixedChains(Random(34, 0));
  const Summary reference = summarize(chains);
  for (auto& chain : chains.chains)
    for (Eigen::Index i = 0; i < chain.draws.rows(); ++i)
      chain.draws(i, 5) = wrapAngle(chain.draws(i, 5) + pi - 0.1);
  const Summary turned = summarize(chains);
  EXPECT_EQ(turned.status, Status::Ok);
  const auto& a = reference.coordinates[5];
  const auto& b = turned.coordinates[5];
  EXPECT_NEAR(wrapAngle(b.mean - a.mean), pi - 0.1, 1e-12);
  EXPECT_NEAR(b.standard_deviation, a.standard_deviation, 1e-12);
  EXPECT_NEAR(b.quantile_97_5 - b.mean, a.quantile_97_5 - a.mean, 1e-12);
  EXPECT_NEAR(b.rhat, a.rhat, 1e-9);
  EXPECT_NEAR(b.bulk_ess, a.bulk_ess, 1e-6 * a.bulk_ess);
}

TEST(Summary, ChainsThatDisagreeAreNotMixed)
{
  ChainSet chains = mixedChains(Random(35, 0));
  chains.chains[2].draws.col(4).array() += 0.05;
  const Summary summary = summarize(chains);
  EXPECT_EQ(summary.status, Status::NotMixed);
  EXPECT_EQ(summary.message.rfind("the chains did not mix", 0), 0u);
  EXPECT_GT(summary.coordinates[4].rhat, 1.1);
  EXPECT_LT(summary.coordinates[0].rhat, 1.01);
}

TEST(Summary, ManyChainsThatDisagreeALittleAreNotMixed)
{
  ChainSet chains = mixedChains(Random(38, 0), 40);
  for (std::size_t c = 0; c < 10; ++c) // half a deviation
    chains.chains[c].draws.col(4).array() += 0.016;
  const Summary summary = summarize(chains);
  EXPECT_GT(summary.coordinates[4].rhat, 1.015);
  EXPECT_LT(summary.coordinates[4].rhat, 1.05);
  EXPECT_GT(summary.coordinates[4].bulk_ess, 500.0);
  EXPECT_EQ(summary.status, Status::NotMixed);
}

TEST(Summary, TooFewDrawsForDiagnosticsAreNotMixed)
{
  const Summary summary = summarize(mixedChains(Random(36, 0), 4, 2));
  EXPECT_EQ(summary.status, Status::NotMixed);
  EXPECT_TRUE(std::isnan(summary.coordinates[0].rhat));
  EXPECT_EQ(summary.message.rfind("8 draws are too few to tell", 0), 0u)
      << summary.message;
}

TEST(Summary, GoodChainsThatAreTooShortAreToldFromBadOnes)
{
  Random random(37, 0);
  for (const int num_draws : {20, 90}) { // of each of four chains
    const Summary summary = summarize(mixedChains(random, 4, num_draws));
    EXPECT_EQ(summary.status, Status::NotMixed);
    EXPECT_NE(summary.message.find("take 2000 draws or more"), std::string::npos)
        << summary.message;
  }
}

TEST(Summary, DivergedChainsAreLeftOutAndReported)
{
  ChainSet chains = mixedChains(Random(37, 0));
  chains.chains[1].draws.setConstant(1e6);
  chains.chains[1].diverged = true;
  const Summary summary = summarize(chains);
  EXPECT_EQ(summary.status, Status::Diverged);
  EXPECT_EQ(summary.num_diverged_chains, 1);
  EXPECT_EQ(summary.num_draws, 1500);
  EXPECT_NEAR(summary.mean[0], 0.1, 0.01);
  EXPECT_EQ(pooledDraws(chains.chains).rows(), 1500);
  for (auto& chain : chains.chains)
    chain.diverged = true;
  const Summary nothing = summarize(chains);
  EXPECT_EQ(nothing.status, Status::Diverged);
  EXPECT_EQ(nothing.num_draws, 0);
  EXPECT_TRUE(nothing.mean.array().isNaN().all());
}

TEST(Summary, ChainsOfUnequalLengthAreAllUsedForTheMoments)
{
  ChainSet chains = mixedChains(Random(39, 0));
  chains.chains[3].draws.conservativeResize(499, 6);
  const Summary summary = summarize(chains);
  EXPECT_EQ(summary.num_draws, 1999);
  EXPECT_EQ(summary.status, Status::Ok);
}

TEST(Summary, ChainsWithFewEffectiveDrawsInTheTailsAreNotMixed)
{
  // Independent but in width: one in ten is wide, and these come 25 at a time.
  ChainSet chains = mixedChains(Random(40, 0));
  for (auto& chain : chains.chains) {
    const double mean = chain.draws.col(1).mean();
    for (Eigen::Index i = 0; i < chain.draws.rows(); ++i)
      if (i / 25 % 10 == 5)
        chain.draws(i, 1) = mean + 20.0 * (chain.draws(i, 1) - mean);
  }
  const Summary summary = summarize(chains);
  const auto& coordinate = summary.coordinates[1];
  ASSERT_LT(coordinate.tail_ess, min_ess);
  ASSERT_GT(coordinate.bulk_ess, min_ess);
  ASSERT_LT(coordinate.rhat, max_rhat);
  EXPECT_EQ(summary.status, Status::NotMixed);
}

TEST(Doubts, LowerNoStatusButOk)
{
  for (const Status status : {Status::Ok,
                              Status::Doubtful,
                              Status::NotMixed,
                              Status::SeveralModes,
                              Status::Diverged,
                              Status::Cancelled}) {
    Summary summary;
    summary.status = status;
    summary.message = "a";
    addDoubts({"b", "c"}, summary);
    const bool was_ok = status == Status::Ok;
    EXPECT_EQ(summary.status, was_ok ? Status::Doubtful : status);
    EXPECT_EQ(summary.message, was_ok ? "a, but b; c" : "a; also b; c");
  }
}

TEST(Doubts, OfRoundingThatIsATenthOfTheVarianceOfADistance)
{
  // From 512 to 1024 m floats are 2^-14 m apart. Rounding to that has a variance of a
  // twelfth of its square, in each of two clouds.
  const double step = std::ldexp(1.0, -14), limit = step * std::sqrt(10.0 / 6.0);
  for (const Preset preset : {Preset::Paper, Preset::Exact, Preset::Calibrated})
    for (const double factor : {0.99, 1.01}) {
      Options options;
      options.preset = preset;
      Summary summary;
      summary.status = Status::Ok;
      summary.num_chains = 4;
      summary.data.is_available = preset == Preset::Calibrated;
      double& noise = preset == Preset::Calibrated ? summary.data.noise_scale
                      : preset == Preset::Exact ? options.exact.scale.measurement_sigma
                                                : options.paper.scale.measurement_sigma;
      noise = factor * limit;
      doubtRounding(700.0, options, summary);
      EXPECT_EQ(summary.status, factor < 1.0 ? Status::Doubtful : Status::Ok)
          << toString(preset) << ' ' << factor;
    }
}

} // namespace
} // namespace bayesian_icp
