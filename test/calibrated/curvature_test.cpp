#include "calibrated/calibrated_estimate.h"
#include "calibrated/calibration_test_support.h"
#include "calibrated/curvature/curvature.h"
#include "calibrated/modes/robust_mode.h"
#include "support/test_support.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/LU>

#include <cmath>

namespace bayesian_icp {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

using test::randomSquare;

TEST(NoiseThreshold, IsExceededByOneInAThousand)
{
  Random random(91, 0);
  for (int nu = 1; nu <= 6; ++nu) {
    // J = A A^T and noise of covariance J in nu of its principal directions.
    const Matrix6d A = randomSquare(random);
    const Matrix6d J = A * A.transpose();
    const Matrix6d noise = 0.3 * A.leftCols(nu) * A.leftCols(nu).transpose();
    const double threshold = noiseThreshold(J, noise);
    const boost::math::chi_squared chi_square(nu);
    // Wilson and Hilferty's quantile is within 3.1 % at one degree of freedom, better
    // beyond: in probability, within a sixth.
    const double probability = cdf(complement(chi_square, nu * threshold));
    EXPECT_NEAR(probability, 1e-3, 1.7e-4) << nu;
    EXPECT_NEAR(nu * threshold / quantile(complement(chi_square, 1e-3)), 1.0, 0.031)
        << nu;
  }
}

/** Secants of a diagonal curvature, with noise along each step. */
Secants
diagonalSecants(const Vector6d& curvature, const Vector6d& noise)
{
  Secants secants;
  secants.steps = Matrix6d::Identity();
  secants.curvature = curvature.asDiagonal();
  secants.differences = secants.curvature;
  for (int k = 0; k < 6; ++k)
    secants.noise[static_cast<std::size_t>(k)] =
        noise[k] * Vector6d::Unit(k) * Vector6d::Unit(k).transpose();
  return secants;
}

/** Information left of \p information with noise of mean 2 and one degree of freedom.
 */
double
keptInformation(double information)
{
  const Secants secants = diagonalSecants(Vector6d::Constant(std::sqrt(information)),
                                          Vector6d::Constant(2));
  const DebitedInformation debited =
      debitedInformation(secants, Matrix6d::Identity(), Vector6d::Zero());
  EXPECT_NEAR(debited.raw[3], information, 1e-12 * information);
  return debited.keep[3] * debited.raw[3];
}

TEST(NoiseDebit, IsContinuousAndMonotone)
{
  const double noise = 2.0;
  const Matrix6d one = Vector6d::Unit(3) * Vector6d::Unit(3).transpose();
  const double threshold = noise * noiseThreshold(Matrix6d::Identity(), one);
  EXPECT_EQ(keptInformation(0.5 * threshold), 0.0);
  EXPECT_EQ(keptInformation(0.999 * threshold), 0.0);
  EXPECT_GT(keptInformation(1.001 * threshold), 0.0);
  for (const double information : {3.0 * threshold, 5.0 * threshold, 1e3 * threshold})
    EXPECT_NEAR(keptInformation(information), information - noise, 1e-9 * information);
  // From a debit of the threshold to one of the noise over two thresholds.
  const double steepest = 1.0 + (threshold - noise) / (2.0 * threshold);
  const double step = 0.01 * threshold;
  double last = 0.0;
  for (double information = step; information < 4.0 * threshold; information += step) {
    const double kept = keptInformation(information);
    EXPECT_GE(kept, last);
    EXPECT_LE(kept - last, steepest * step * (1.0 + 1e-9));
    EXPECT_LE(kept, information);
    last = kept;
  }
}

TEST(NoiseDebit, InformationIsTheSandwichAlongWhatIsKept)
{
  Random random(92, 0);
  const Matrix6d root = randomSquare(random), A = randomSquare(random);
  const Matrix6d J = A * A.transpose();
  Secants secants;
  secants.curvature = 10.0 * root * root.transpose();
  secants.steps = randomSquare(random);
  secants.noise.fill(Matrix6d::Zero());
  const Matrix6d sandwich = secants.curvature * J.inverse() * secants.curvature;
  const DebitedInformation all = debitedInformation(secants, J, Vector6d::Zero());
  EXPECT_EQ(all.keep, Vector6d::Ones());
  EXPECT_LT((all.information - sandwich).norm(), 1e-9 * sandwich.norm());
  // Noise beyond all information along one step: nothing is left of that step alone.
  secants.noise[2] = 1e6 * J;
  const DebitedInformation some = debitedInformation(secants, J, Vector6d::Zero());
  EXPECT_EQ(some.keep[2], 0.0);
  EXPECT_LT((some.information * secants.steps.col(2)).norm(), 1e-9 * sandwich.norm());
  for (const int k : {0, 1, 3, 4, 5}) {
    const Vector6d step = secants.steps.col(k);
    EXPECT_NEAR(step.dot(some.information * step), all.raw[k], 1e-9 * all.raw[k]);
  }
}

TEST(NoiseDebit, LeavesWhatThePriorKnowsBetterToThePrior)
{
  Vector6d curvature = Vector6d::Ones();
  curvature[1] = 0.1;
  const Secants secants = diagonalSecants(curvature, Vector6d::Zero());
  const auto keep = [&](double least) {
    return debitedInformation(secants, Matrix6d::Identity(), Vector6d::Constant(least))
        .keep;
  };
  EXPECT_EQ(keep(0.009), Vector6d::Ones());
  Vector6d expected = Vector6d::Ones();
  expected[1] = 0.0;
  EXPECT_EQ(keep(0.011), expected);
}

// ---- H on an exact target, against many noisy scans of it ----

/** E (psi(z + shift) - psi(z - shift)) / 2 of Tukey's psi for a standard normal z, by
 * the trapezoidal rule. */
double
expectedDifference(double shift)
{
  constexpr double c = SurfaceScorer::tukey_constant, step = 0.01, end = 8.0;
  const auto psi = [](double u) {
    const double v = u * u / (c * c);
    return v < 1.0 ? u * (1.0 - v) * (1.0 - v) : 0.0;
  };
  double sum = 0.0;
  for (double z = -end; z <= end; z += step)
    sum += 0.5 * (psi(z + shift) - psi(z - shift)) * std::exp(-0.5 * z * z) * step;
  return sum / std::sqrt(2.0 * std::acos(-1.0));
}

TEST(Secants, AreTheSlopeOfMeanScoresOverManyScans)
{
  constexpr int num_scans = 60;
  constexpr double sigma = 0.001;
  // An exact box, and source points on it whose noise is drawn anew: away from the
  // edges, where the nearest patch is on the point's own face.
  Random of_scene(93, 0), random(94, 0);
  const Vector3d half(0.1, 0.08, 0.06);
  SurfaceModelOptions without_gaps;
  without_gaps.num_exact_neighbors = 30;
  const SurfaceModel model(test::box(of_scene, 6000, half).points, without_gaps);
  const test::Sheet sheet = test::box(of_scene, 500, half, 0.03);
  const Isometry3d truth = Isometry3d::Identity();
  const Vector3d centre = sheet.points.rowwise().mean();
  // Residuals are in units of the target's noise, of which there is hardly any.
  const double tau = sigma / model.medianSigma();
  const Matrix6Xd jacobians = test::distanceJacobians(sheet) / model.medianSigma();
  const Matrix6d gauss_newton = jacobians * jacobians.transpose();

  const SurfaceScorer scorer(test::noisy(sheet, sigma, random), model);
  const SurfaceScores at_mode = test::scoresAt(scorer, truth, centre, tau);
  ASSERT_GT(at_mode.num_active, 450);
  const SecantPlan plan = {(gauss_newton / (tau * tau)).inverse(),
                           displacementMetric(scorer, truth),
                           1e-6 * Matrix6d::Identity(),
                           sigma};
  const Secants secants = measureSecants(scorer, truth, at_mode, tau, plan);

  // Slopes along the same steps, over scans that the secants have not seen.
  const Matrix6d& V = secants.steps;
  std::vector<Matrix6d> slopes;
  Matrix6d mean = Matrix6d::Zero(), variance = Matrix6d::Zero();
  for (int scan = 0; scan < num_scans; ++scan) {
    const SurfaceScorer other(test::noisy(sheet, sigma, random), model);
    const auto totalAfter = [&](const Vector6d& step) {
      return test::scoresAt(other, movedBy(step, centre, truth), centre, tau).total;
    };
    Matrix6d differences;
    for (int k = 0; k < 6; ++k)
      differences.col(k) = 0.5 * (totalAfter(V.col(k)) - totalAfter(-V.col(k)));
    const Matrix6d products = V.transpose() * differences;
    slopes.push_back(0.5 * (products + products.transpose()));
    mean += slopes.back() / num_scans;
  }
  for (const Matrix6d& slope : slopes)
    variance += (slope - mean).cwiseAbs2() / (num_scans - 1);
  const Matrix6d measured = V.transpose() * secants.curvature * V;
  // In closed form: on a plane, a point's residual moves by jacobian * step.
  Matrix6d expected = Matrix6d::Zero();
  for (Index i = 0; i < jacobians.cols(); ++i)
    for (int k = 0; k < 6; ++k)
      expected.col(k) += tau *
                         expectedDifference(jacobians.col(i).dot(V.col(k)) / tau) *
                         V.transpose() * jacobians.col(i);
  // A hundredth of the points meet a patch that is not usable, and are not counted.
  const double share_lost = 1.0 - at_mode.num_active / double(jacobians.cols());
  EXPECT_LT(share_lost, 0.02);
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) {
      const double error = std::sqrt(variance(i, k));
      EXPECT_NEAR(measured(i, k), mean(i, k), 4.5 * error) << i << k;
      const double scale = std::sqrt(mean(i, i) * mean(k, k));
      EXPECT_LT(error, 0.05 * scale);
      EXPECT_NEAR(mean(i, k),
                  expected(i, k),
                  4.5 * error / std::sqrt(num_scans) + share_lost * scale)
          << i << k;
    }
}

// ---- What a plane does not hold ----

TEST(Curvature, APlaneLeavesThreeMotionsToThePrior)
{
  constexpr double sigma = 0.001;
  const Vector6d sd(0.02, 0.02, 0.02, 0.05, 0.05, 0.05);
  for (std::uint64_t stream = 0; stream < 6; ++stream) {
    SCOPED_TRACE(stream);
    Random random(95, stream);
    const Matrix3Xd target =
        test::noisy(test::squarePlane(random, 3000, 0.3), sigma, random);
    const Matrix3Xd source =
        test::noisy(test::squarePlane(random, 600, 0.15), sigma, random);
    const CalibratedEstimate e = test::Problem(source, target, sd).estimate();
    int num_prior_only = 0;
    for (int k = 0; k < 6; ++k) {
      const Vector6d direction = e.directions.col(k);
      const Vector6d by_data = e.information * direction;
      if (e.keep[k] > 0.0)
        continue;
      ++num_prior_only;
      // The sliding motions x, y and yaw: of unit displacement, so as large as one.
      EXPECT_LT(Vector3d(direction[2], direction[3], direction[4]).norm(),
                0.1 * direction.norm());
      // Nothing is said along it, so the posterior's precision is the prior's.
      EXPECT_LT(by_data.norm(), 1e-9 * e.information.norm() * direction.norm());
    }
    EXPECT_EQ(num_prior_only, 3);
    for (const int k : {0, 1, 5})
      EXPECT_NEAR(std::sqrt(e.covariance(k, k)), sd[k], 0.02 * sd[k]) << k;
    for (const int k : {2, 3, 4})
      EXPECT_LT(std::sqrt(e.covariance(k, k)), 0.1 * sd[k]) << k;
  }
}

} // namespace
} // namespace bayesian_icp
