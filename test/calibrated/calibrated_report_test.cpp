// The report of a calibrated estimate: numbers, directions, flags and their thresholds.
#include "calibrated/calibrated_report.h"
#include "support/test_support.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace {

const Eigen::Vector3d body_centre(1.0, 2.0, 3.0);

/** [m] */
constexpr double target_noise = 0.002;

/** An estimate whose directions are the axes: a source of unit radius, a diagonal
 * prior, and what the data know of each. */
CalibratedEstimate
diagonalEstimate()
{
  CalibratedEstimate estimate;
  estimate.centre = body_centre;
  estimate.residual_scale = 1.5;
  estimate.scores.residuals.setZero(150);
  estimate.scores.num_source_points = 100;
  estimate.scores.num_active_of_source = 90;
  estimate.scores.num_active = 90 + 10;
  estimate.keep << 1.0, 0.9, 0.4, 0.0, 1.0, 0.5;
  const Vector6d relative_information(99.0, 24.0, 3.0, 0.0, 399.0, 8.0);
  estimate.prior.precision = Vector6d::Constant(4.0).asDiagonal();
  const Vector6d information = 4.0 * relative_information;
  estimate.information = information.asDiagonal();
  estimate.covariance = (estimate.information + estimate.prior.precision).inverse();
  // J = 1: the information before the debit is the curvature's square.
  estimate.score_covariance.setIdentity();
  for (int k = 0; k < 6; ++k)
    if (estimate.keep[k] > 0.0)
      estimate.curvature(k, k) = std::sqrt(information[k] / estimate.keep[k]);
  estimate.kappa_48 = 1.5;
  estimate.kappa_inf = 3.0;
  estimate.other_end[0] = 0.1;
  return estimate;
}

TEST(Report, ClosedFormOfADiagonalEstimate)
{
  const DataReport report = dataReportOf(diagonalEstimate(), target_noise);
  EXPECT_TRUE(report.is_available);
  EXPECT_DOUBLE_EQ(report.residual_scale, 1.5);
  EXPECT_DOUBLE_EQ(report.noise_scale, 1.5 * target_noise);
  EXPECT_DOUBLE_EQ(report.active_fraction, 0.9);
  EXPECT_DOUBLE_EQ(report.active_fraction_of_target, 0.2);
  EXPECT_DOUBLE_EQ(report.effective_patches, 48.0);
  EXPECT_DOUBLE_EQ(report.correlation_factor, 3.0);
  // Variance 1 / 400 m^2 of the posterior, and half the noise.
  EXPECT_NEAR(
      report.basin_distance, 0.1 / std::hypot(0.05, 0.5 * report.noise_scale), 1e-12);
  EXPECT_EQ(report.centre, body_centre);

  // Sorted by 1 / sqrt(4 (1 + relative information)).
  const double information[] = {399.0, 99.0, 24.0, 8.0, 3.0, 0.0};
  const int columns[] = {4, 0, 1, 5, 2, 3};
  constexpr auto observed = Observability::Observed, weak = Observability::Weak;
  const Observability observability[] = {
      observed, observed, observed, observed, weak, Observability::PriorOnly};
  ASSERT_EQ(report.directions.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const DataDirection& direction = report.directions[i];
    EXPECT_NEAR(std::abs(direction.twist[columns[i]]), 1.0, 1e-12);
    EXPECT_NEAR(
        direction.standard_deviation, 0.5 / std::sqrt(1.0 + information[i]), 1e-12);
    EXPECT_NEAR(direction.prior_standard_deviation, 0.5, 1e-12);
    EXPECT_NEAR(direction.relative_information, information[i], 1e-10);
    EXPECT_EQ(direction.observability, observability[i]) << i;
    EXPECT_EQ(direction.description, describeTwist(direction.twist, body_centre));
  }
}

TEST(Report, WhatHardlyNarrowsThePriorIsNotObserved)
{
  // Standard deviations are 1 / sqrt(1 + information) times the prior's: 0.9902,
  // 0.9898, 0.709, 0.705.
  const double information[] = {0.0199, 0.0207, 0.99, 1.01};
  const Observability expected[] = {Observability::PriorOnly,
                                    Observability::Weak,
                                    Observability::Weak,
                                    Observability::Observed};
  CalibratedEstimate estimate = diagonalEstimate();
  for (std::size_t i = 0; i < 4; ++i) {
    estimate.information(0, 0) = 4.0 * information[i];
    estimate.curvature(0, 0) = std::sqrt(4.0 * information[i]);
    estimate.covariance(0, 0) = 0.25 / (1.0 + information[i]);
    const DataReport report = dataReportOf(estimate, target_noise);
    const auto found = std::find_if(
        report.directions.begin(), report.directions.end(), [](const DataDirection& d) {
          return std::abs(d.twist[0]) > 0.999;
        });
    ASSERT_NE(found, report.directions.end());
    EXPECT_EQ(found->observability, expected[i]) << information[i];
  }
}

TEST(Report, DirectionsAreIndependentInPosteriorAndPrior)
{
  // Neither the information nor the prior nor the metric is diagonal; the data say
  // nothing along two oblique twists.
  Random random(9, 0);
  const Matrix6d A = test::randomSquare(random), B = test::randomSquare(random),
                 C = test::randomSquare(random);
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.prior.precision = B * B.transpose() + Matrix6d::Identity();
  estimate.displacement_metric = C * C.transpose() + Matrix6d::Identity();
  const Eigen::Matrix<double, 4, 6> rows = 10.0 * A.topRows<4>();
  estimate.information = rows.transpose() * rows;
  estimate.curvature = estimate.information;
  estimate.score_covariance = estimate.information + 1e-9 * Matrix6d::Identity();
  estimate.covariance = (estimate.information + estimate.prior.precision).inverse();
  const DataReport report = dataReportOf(estimate, target_noise);
  int num_free = 0;
  for (const DataDirection& a : report.directions) {
    EXPECT_NEAR(a.twist.dot(estimate.displacement_metric * a.twist), 1.0, 1e-10);
    EXPECT_NEAR(a.standard_deviation / a.prior_standard_deviation,
                1.0 / std::sqrt(1.0 + a.relative_information),
                1e-10);
    for (const DataDirection& b : report.directions) {
      if (&a == &b)
        continue;
      const double scale = a.prior_standard_deviation * b.prior_standard_deviation;
      EXPECT_NEAR(scale * a.twist.dot(estimate.prior.precision * b.twist), 0.0, 1e-8);
      const double spread = a.standard_deviation * b.standard_deviation;
      EXPECT_NEAR(spread * a.twist.dot(estimate.information * b.twist), 0.0, 1e-8);
    }
    if (a.observability == Observability::PriorOnly) {
      ++num_free;
      EXPECT_NEAR((rows * a.twist).norm(), 0.0, 1e-6);
    }
  }
  EXPECT_EQ(num_free, 2);
}

TEST(Report, ThePriorsProbabilityIsOfWhatTheDataHold)
{
  // The prior's deviation is 0.5; the fourth direction is held by it only.
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.prior.deviation << 0.5, 0.0, 0.0, 1e3, 1.0, 0.5;
  estimate.mean << 0.0, 0.0, 0.0, 0.0, 0.5, 0.0;
  // The means' distances have 99/100, 399/400 and 8/9 of the prior's variance.
  const double squared_distance = 1.0 / 0.99 + 9.0 * 400.0 / 399.0 + 9.0 / 8.0;
  const auto tail = [](int degrees, double x) {
    return cdf(complement(boost::math::chi_squared(degrees), x));
  };
  EXPECT_NEAR(dataReportOf(estimate, target_noise).prior_probability,
              tail(5, squared_distance),
              1e-12);
  // Held by five, four, ... directions.
  for (int k = 0; k < 6; ++k) {
    if (k == 3)
      continue;
    estimate.information(k, k) = 0.0;
    estimate.prior.deviation[k] = 0.0;
    estimate.mean[k] = 0.0;
    double distance = 0.0;
    int num_held = 0;
    for (int i = k + 1; i < 6; ++i)
      if (i != 3) {
        ++num_held;
        distance += std::pow(2.0 * (estimate.prior.deviation + estimate.mean)[i], 2) *
                    (1.0 + 4.0 / estimate.information(i, i));
      }
    EXPECT_NEAR(dataReportOf(estimate, target_noise).prior_probability,
                num_held > 0 ? tail(num_held, distance) : 1.0,
                1e-12)
        << k;
  }
}

TEST(Report, ThePriorsProbabilityIsUniformForPosesOfThePrior)
{
  // One direction, half of whose variance the data take away: they tell the true pose
  // with the prior's deviation, and the mean is half of what they tell.
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.information.setZero();
  estimate.information(0, 0) = estimate.prior.precision(0, 0);
  Random random(7, 0);
  constexpr int num_runs = 2000;
  int num_below_half = 0;
  for (int i = 0; i < num_runs; ++i) {
    const double told = 0.5 * random.normal() + 0.5 * random.normal();
    estimate.mean[0] = 0.5 * told;
    num_below_half += dataReportOf(estimate, target_noise).prior_probability < 0.5;
  }
  EXPECT_NEAR(num_below_half, 0.5 * num_runs, 4.0 * std::sqrt(0.25 * num_runs));
}

TEST(Report, StartsMayDifferFreelyWherePriorOnlyHolds)
{
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.other_end << 0.0, 0.0, 0.0, 50.0, 0.0, 0.0;
  EXPECT_NEAR(dataReportOf(estimate, target_noise).basin_distance, 0.0, 1e-6);
}

/** An estimate without flags. */
CalibratedEstimate
goodEstimate()
{
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.residual_scale = 1.0;
  estimate.kappa_48 = estimate.kappa_inf = 1.2;
  estimate.other_end.setZero();
  return estimate;
}

/** Flags of goodEstimate() after \p change. */
template <typename Change>
DataFlags
flagsAfter(const Change& change)
{
  CalibratedEstimate estimate = goodEstimate();
  change(estimate);
  return dataReportOf(estimate, target_noise).flags;
}

TEST(Report, FlagsAreRaisedBeyondTheirThresholds)
{
  using E = CalibratedEstimate;
  EXPECT_FALSE(flagsAfter([](E&) {}).any());
  // 20 standard deviations a metre along x; half the noise is 2 % of one.
  EXPECT_FALSE(flagsAfter([](E& e) { e.other_end[0] = 0.149; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.other_end[0] = 0.151; }).wrong_basin);
  EXPECT_FALSE(flagsAfter([](E& e) {
                 e.other_end[0] = 1.0;
                 e.other_cost_ratio = max_other_cost_ratio + 0.01;
               }).any());
  // Points of 100 of the source and 50 of the target.
  const auto flagsWithActive = [](int of_source, int of_target) {
    return flagsAfter([=](E& e) {
      e.scores.num_active_of_source = of_source;
      e.scores.num_active = of_source + of_target;
    });
  };
  EXPECT_FALSE(flagsWithActive(40, 0).any());
  EXPECT_FALSE(flagsWithActive(39, 20).any());
  EXPECT_TRUE(flagsWithActive(39, 19).low_support);
  EXPECT_FALSE(flagsAfter([](E& e) { e.kappa_inf = 5.75; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.kappa_inf = 5.77; }).few_patches);
  // The prior alone holds one direction, which a disagreement may hide ...
  EXPECT_FALSE(flagsAfter([](E& e) { e.residual_scale = 1.99; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.residual_scale = 2.01; }).misfit);
  // ... and here none.
  const auto hold_all = [](E& e, double residual_scale) {
    e.information(3, 3) = 400.0;
    e.curvature(3, 3) = 20.0;
    e.residual_scale = residual_scale;
  };
  EXPECT_FALSE(flagsAfter([&](E& e) { hold_all(e, 9.99); }).any());
  EXPECT_TRUE(flagsAfter([&](E& e) { hold_all(e, 10.01); }).misfit);
  // Residuals of three times the noise need 28 patches in place of 20; 115.2 / kappa
  // are these.
  const auto repeat = [&](double residual_scale, double kappa) {
    return flagsAfter([&](E& e) {
      hold_all(e, residual_scale);
      e.kappa_inf = kappa;
    });
  };
  EXPECT_FALSE(repeat(2.99, 4.12).any());
  EXPECT_TRUE(repeat(3.01, 4.12).few_patches);
  EXPECT_FALSE(repeat(3.01, 4.11).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.information.setZero(); }).no_information);
  // Of five directions: 0.1 % are beyond 20.515 = (2 * 2.2533)^2 / 0.99.
  const auto deviate = [](E& e, double metres) { e.prior.deviation[0] = metres; };
  EXPECT_FALSE(flagsAfter([&](E& e) { deviate(e, 2.253); }).any());
  EXPECT_TRUE(flagsAfter([&](E& e) { deviate(e, 2.254); }).prior_conflict);
  // Of all six: 0.1 % are beyond 22.458.
  EXPECT_FALSE(flagsAfter([](E& e) { e.better_fit = 22.45; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.better_fit = 22.46; }).prior_conflict);
}

TEST(Report, WhatIsNotANumberIsFlagged)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const DataFlags flags = flagsAfter([nan](CalibratedEstimate& e) {
    e.residual_scale = e.kappa_inf = e.other_end[0] = e.prior.deviation[0] = nan;
  });
  EXPECT_TRUE(flags.wrong_basin && flags.few_patches && flags.misfit &&
              flags.prior_conflict);
}

} // namespace
} // namespace bayesian_icp
