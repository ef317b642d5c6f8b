// The baselines' covariances: derivatives, known values, re-simulation.
#include "baselines/covariances.h"
#include "geometry/twist.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <numeric>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/** Pairs that no pose brings together: the target is the moved source, larger by 30 %
 * and roughened, so that second derivatives of the rotation matter. Every target point
 * is in two pairs. */
struct Misfit {
  Matrix3Xd source;
  Isometry3d pose = Isometry3d::Identity();
  MatchedPoints matches;
  Vector3d centre;

  explicit Misfit(bool has_normals, Index num_pairs = 40)
  {
    Random random(31, 0);
    source = test::randomPoints(random, num_pairs, {0.4, -0.3, 0.8});
    pose = isometryOf(test::randomPose(random));
    matches.moved = pose * source;
    centre = matches.moved.rowwise().mean();
    matches.target.resize(3, num_pairs);
    for (Index i = 0; i < num_pairs; ++i) {
      const Index twin = i - i % 2;
      const auto index = static_cast<std::uint32_t>(twin);
      matches.target_indices.push_back(index);
      const Vector3d rough(random.normal(), random.normal(), random.normal());
      matches.target.col(i) =
          i == twin
              ? Vector3d(centre + 1.3 * (matches.moved.col(i) - centre) + 0.02 * rough)
              : Vector3d(matches.target.col(twin));
    }
    if (has_normals)
      matches.normals = someNormals(random, num_pairs);
  }

  static Matrix3Xd
  someNormals(Random& random, Index count)
  {
    Matrix3Xd normals(3, count);
    for (Index i = 0; i < count; ++i)
      normals.col(i) =
          Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    return normals;
  }

  MatchedPoints
  movedBy(const Vector6d& xi) const
  {
    MatchedPoints moved = matches;
    moved.moved = bayesian_icp::movedBy(xi, centre, pose) * source;
    return moved;
  }

  double
  energy(const Vector6d& xi) const
  {
    return 0.5 * gaussNewton(movedBy(xi), centre).sum_of_squares;
  }

  /** Go to the minimum by Newton's method; \return whether it is there. */
  bool
  minimise()
  {
    for (int i = 0; i < 50; ++i) {
      const auto d = closedFormDerivatives(matches, centre);
      const GaussNewton sums = gaussNewton(matches, centre);
      const bool is_near = d.gradient.norm() < 1e-2;
      const Vector6d step =
          -(is_near ? d.hessian : sums.hessian).ldlt().solve(d.gradient);
      pose = bayesian_icp::movedBy(step, centre, pose);
      matches.moved = pose * source;
      if (step.norm() < 1e-11)
        return true;
    }
    return false;
  }
};

/** Second derivatives of \p f at zero by central differences. */
Matrix6d
centralSecondDifferences(const std::function<double(const Vector6d&)>& f, double step)
{
  Matrix6d result;
  for (int k = 0; k < 6; ++k)
    for (int l = 0; l < 6; ++l) {
      const Vector6d a = step * Vector6d::Unit(k), b = step * Vector6d::Unit(l);
      result(k, l) = (f(a + b) - f(a - b) - f(b - a) + f(-a - b)) / (4.0 * step * step);
    }
  return result;
}

class Residuals : public ::testing::TestWithParam<bool> {};

TEST_P(Residuals, DerivativesAreThoseOfTheEnergy)
{
  const Misfit misfit(GetParam());
  const auto d = closedFormDerivatives(misfit.matches, misfit.centre);
  const auto energy = [&](const Vector6d& xi) { return misfit.energy(xi); };
  // Fourth derivatives are about the energy's scale n * 0.5^2 = 10, so that a step of
  // 1e-3 errs by 1e-5 and round-off by 1e-15 * 10 / 1e-6 = 1e-8.
  const Matrix6d hessian = centralSecondDifferences(energy, 1e-3);
  EXPECT_LT((d.hessian - hessian).norm(), 1e-4) << d.hessian << "\n\n" << hessian;
  const Vector6d gradient = test::centralDifferences(energy, Vector6d::Zero(), 1e-4);
  EXPECT_LT((d.gradient - gradient).norm(), 1e-6);
  EXPECT_LT((gaussNewton(misfit.matches, misfit.centre).gradient - gradient).norm(),
            1e-6);
  // The second derivatives of the rotation are no small thing here.
  EXPECT_GT((gaussNewton(misfit.matches, misfit.centre).hessian - hessian).norm(),
            0.05 * hessian.norm());
}

/** Sum over all point coordinates z of (d2J/dz dx)(d2J/dz dx)^T, by differences. */
Matrix6d
gradientCovarianceByDifferences(const Misfit& misfit)
{
  const double step = 1e-5;
  const auto gradient = [&](const MatchedPoints& m) {
    return gaussNewton(m, misfit.centre).gradient;
  };
  Matrix6d sum = Matrix6d::Zero();
  for (Index i = 0; i < misfit.source.cols(); ++i)
    for (int k = 0; k < 3; ++k) {
      MatchedPoints high = misfit.matches, low = misfit.matches;
      high.moved(k, i) += step;
      low.moved(k, i) -= step;
      Vector6d column = (gradient(high) - gradient(low)) / (2.0 * step);
      sum += column * column.transpose();
      if (i % 2 == 1)
        continue;
      high = low = misfit.matches;
      for (const Index j : {i, i + 1}) { // the target point that both pairs share
        high.target(k, j) += step;
        low.target(k, j) -= step;
      }
      column = (gradient(high) - gradient(low)) / (2.0 * step);
      sum += column * column.transpose();
    }
  return sum;
}

TEST_P(Residuals, NoiseOfEveryCoordinateReachesTheGradient)
{
  const Misfit misfit(GetParam());
  const auto d = closedFormDerivatives(misfit.matches, misfit.centre);
  const Matrix6d numerical = gradientCovarianceByDifferences(misfit);
  // The gradient is a polynomial of second degree in z: only round-off remains.
  EXPECT_LT((d.gradient_covariance - numerical).norm(), 1e-7 * numerical.norm());
}

TEST_P(Residuals, CovarianceIsThatOfRepeatedRegistrations)
{
  constexpr double sigma = 1e-3;
  constexpr int num_runs = 2000;
  Misfit misfit(GetParam());
  ASSERT_TRUE(misfit.minimise());
  const auto d = closedFormDerivatives(misfit.matches, misfit.centre);
  const Matrix6d L = closedFormCovariance(d, sigma).llt().matrixL();
  Random random(32, 0);
  const auto noise = [&] {
    return Vector3d(
        sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
  };
  Matrix6d second_moment = Matrix6d::Zero();
  Vector6d sum = Vector6d::Zero();
  for (int run = 0; run < num_runs; ++run) {
    Misfit noisy = misfit;
    for (Index i = 0; i < noisy.source.cols(); ++i) {
      noisy.source.col(i) += noise();
      noisy.matches.target.col(i) =
          i % 2 == 0 ? Vector3d(misfit.matches.target.col(i) + noise())
                     : Vector3d(noisy.matches.target.col(i - 1));
    }
    noisy.matches.moved = noisy.pose * noisy.source;
    ASSERT_TRUE(noisy.minimise());
    const Vector6d xi = twistBetween(misfit.pose, noisy.pose, misfit.centre);
    const Vector6d whitened = L.triangularView<Eigen::Lower>().solve(xi);
    second_moment += whitened * whitened.transpose() / num_runs;
    sum += whitened;
  }
  // Entries of a Wishart mean: standard deviation sqrt(2 / n) on the diagonal,
  // sqrt(1 / n) off it. 21 entries, 4.5 of them: passes by chance alone with a
  // probability of 0.9999.
  const Matrix6d error = second_moment - Matrix6d::Identity();
  for (int k = 0; k < 6; ++k)
    for (int l = 0; l <= k; ++l)
      EXPECT_LT(std::abs(error(k, l)), 4.5 * std::sqrt((k == l ? 2.0 : 1.0) / num_runs))
          << second_moment;
  // What Gauss-Newton's Hessian and independent pairs would say is told apart.
  const Matrix6d naive = L.triangularView<Eigen::Lower>().solve(hessianCovariance(
      gaussNewton(misfit.matches, misfit.centre).hessian, std::sqrt(2.0) * sigma));
  const Matrix6d whitened_naive =
      L.triangularView<Eigen::Lower>().solve(naive.transpose());
  EXPECT_GT((whitened_naive - second_moment).cwiseAbs().maxCoeff(),
            2.0 * 4.5 * std::sqrt(2.0 / num_runs));
}

TEST_P(Residuals, InformationIsTheInverse)
{
  Misfit misfit(GetParam());
  const auto before = closedFormDerivatives(misfit.matches, misfit.centre);
  const auto i = closedFormInformation(before, 0.01);
  const Matrix6d product = i.information * closedFormCovariance(before, 0.01);
  EXPECT_LT((product - Matrix6d::Identity()).norm(), 1e-9);
  const Vector6d step = before.hessian.ldlt().solve(before.gradient);
  EXPECT_LT((i.information.ldlt().solve(i.gradient) - step).norm(), 1e-9 * step.norm());
}

/** The same covariance, once in twists about a centre, once about the origin. */
TEST_P(Residuals, CovarianceAboutTheOriginIsLeftSE3)
{
  Misfit misfit(GetParam());
  ASSERT_TRUE(misfit.minimise());
  const Matrix6d about_centre =
      closedFormCovariance(closedFormDerivatives(misfit.matches, misfit.centre), 0.01);
  const Matrix6d about_origin = closedFormCovariance(
      closedFormDerivatives(misfit.matches, Vector3d::Zero()), 0.01);
  // Jacobian of LeftSE3 errors with respect to twists about the centre, by pose.h.
  const Vector6d mean = poseOf(misfit.pose.matrix());
  const auto error = [&](const Vector6d& xi) {
    return poseError(poseOf(movedBy(xi, misfit.centre, misfit.pose).matrix()),
                     mean,
                     CovarianceConvention::LeftSE3);
  };
  Matrix6d jacobian;
  for (int k = 0; k < 6; ++k)
    jacobian.col(k) =
        (error(1e-5 * Vector6d::Unit(k)) - error(-1e-5 * Vector6d::Unit(k))) / 2e-5;
  EXPECT_LT((jacobian * about_centre * jacobian.transpose() - about_origin).norm(),
            1e-7 * about_origin.norm());
}

INSTANTIATE_TEST_SUITE_P(Baselines,
                         Residuals,
                         ::testing::Bool(),
                         [](const auto& param) {
                           return param.param ? "PointToPlane" : "PointToPoint";
                         });

TEST(ClosedForm, KnowsNothingOfSlidingOnAPlane)
{
  Random random(33, 0);
  MatchedPoints matches;
  matches.moved = test::randomPoints(random, 50, Vector3d::Zero());
  matches.moved.row(2).setZero();
  matches.target = matches.moved;
  matches.normals = Vector3d::UnitZ().replicate(1, 50);
  matches.target_indices.resize(50);
  std::iota(matches.target_indices.begin(), matches.target_indices.end(), 0u);
  const auto i =
      closedFormInformation(closedFormDerivatives(matches, Vector3d::Zero()), 0.01);
  ASSERT_TRUE(i.information.allFinite());
  const double largest = i.information.norm();
  for (const int free : {0, 1, 5})
    EXPECT_LT(i.information.col(free).norm(), 1e-9 * largest);
  // Height: the mean of 50 differences of two coordinates.
  EXPECT_NEAR(i.information(2, 2), 50 / (2 * 0.01 * 0.01), 1e-6 * largest);
}

TEST(HessianCovariance, KnownValues)
{
  MatchedPoints matches;
  matches.moved.resize(3, 2);
  matches.moved << 1, -1, 0, 0, 0, 0;
  matches.target = matches.moved;
  matches.target.row(2).array() += 0.5;
  GaussNewton sums = gaussNewton(matches, Vector3d::Zero());
  EXPECT_EQ(sums.num_residuals, 6);
  EXPECT_DOUBLE_EQ(residualVariance(sums), 2 * 0.25 / 6);
  Vector6d diagonal;
  diagonal << 2, 2, 2, 0, 2, 2; // two points on the x axis, 1 m off
  EXPECT_EQ(sums.hessian, Matrix6d(diagonal.asDiagonal()));
  EXPECT_TRUE(std::isnan(residualVariance(GaussNewton())));

  const std::vector<Eigen::Matrix3d> covariances(
      2, Eigen::Vector3d(4.0, 4.0, 0.25).asDiagonal());
  const Matrix6d gicp =
      generalizedIcpHessian(matches.moved, covariances, Vector3d::Zero());
  diagonal << 0.5, 0.5, 8, 0, 8, 0.5;
  EXPECT_EQ(gicp, Matrix6d(diagonal.asDiagonal()));
  const Matrix6d H = gicp + Matrix6d::Identity();
  EXPECT_DOUBLE_EQ(hessianCovariance(H, 0.3)(2, 2), 0.09 / 9.0);
}

} // namespace
} // namespace bayesian_icp
