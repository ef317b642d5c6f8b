// The report of a calibrated estimate: numbers, directions, flags and their thresholds.
#include <bayesian_icp/calibration/calibrated_report.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace {

const Eigen::Vector3d centre(1.0, 2.0, 3.0);

/** An estimate whose directions are the axes: a source of unit radius, a diagonal
 * prior, and what the data know of each. */
CalibratedEstimate
diagonalEstimate()
{
  CalibratedEstimate estimate;
  estimate.centre = centre;
  estimate.residual_scale = 1.5;
  estimate.scores.num_active = 90;
  estimate.keep << 1.0, 0.9, 0.4, 0.0, 1.0, 0.5;
  estimate.relative_information << 99.0, 24.0, 3.0, 0.0, 399.0, 8.0;
  estimate.prior.precision = Vector6d::Constant(4.0).asDiagonal();
  const Vector6d information = 4.0 * estimate.relative_information;
  estimate.information = information.asDiagonal();
  estimate.covariance = (estimate.information + estimate.prior.precision).inverse();
  estimate.kappa_48 = 1.5;
  estimate.kappa_inf = 3.0;
  estimate.other_end[0] = 0.1;
  return estimate;
}

TEST(Report, ClosedFormOfADiagonalEstimate)
{
  const DataReport report = dataReportOf(diagonalEstimate(), 100, 0.002);
  EXPECT_TRUE(report.is_available);
  EXPECT_DOUBLE_EQ(report.residual_scale, 1.5);
  EXPECT_DOUBLE_EQ(report.noise_scale, 0.003);
  EXPECT_DOUBLE_EQ(report.active_fraction, 0.9);
  EXPECT_DOUBLE_EQ(report.effective_patches, 48.0);
  EXPECT_DOUBLE_EQ(report.correlation_factor, 3.0);
  EXPECT_NEAR(report.basin_distance, 0.1 * std::sqrt(400.0), 1e-12);
  EXPECT_EQ(report.centre, centre);

  // Sorted by 1 / sqrt(4 (1 + relative information)).
  const double information[] = {399.0, 99.0, 24.0, 8.0, 3.0, 0.0};
  const int columns[] = {4, 0, 1, 5, 2, 3};
  const Observability observability[] = {Observability::Observed,
                                         Observability::Observed,
                                         Observability::Observed,
                                         Observability::Observed,
                                         Observability::Weak,
                                         Observability::PriorOnly};
  ASSERT_EQ(report.directions.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const DataDirection& direction = report.directions[i];
    EXPECT_EQ(direction.twist, Vector6d(Vector6d::Unit(columns[i])));
    EXPECT_NEAR(
        direction.standard_deviation, 0.5 / std::sqrt(1.0 + information[i]), 1e-12);
    EXPECT_NEAR(direction.prior_standard_deviation, 0.5, 1e-12);
    EXPECT_EQ(direction.relative_information, information[i]);
    EXPECT_EQ(direction.observability, observability[i]) << i;
    EXPECT_EQ(direction.description, describeTwist(direction.twist, centre));
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
    estimate.covariance(0, 0) = 0.25 / (1.0 + information[i]);
    const DataReport report = dataReportOf(estimate, 100, 0.002);
    const auto found =
        std::find_if(report.directions.begin(),
                     report.directions.end(),
                     [](const DataDirection& d) { return d.twist[0] == 1.0; });
    ASSERT_NE(found, report.directions.end());
    EXPECT_EQ(found->observability, expected[i]) << information[i];
  }
}

TEST(Report, DeviationsAlongObliqueDirectionsAreThoseOfTheirCoordinates)
{
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.directions(0, 1) = 1.0; // the second direction leans towards the first
  const DataReport report = dataReportOf(estimate, 100, 0.002);
  // Coordinates c of xi = V c: c_1 = xi_1, c_0 = xi_0 - xi_1.
  const auto& covariance = estimate.covariance;
  for (const DataDirection& direction : report.directions) {
    const double prior_precision = 4.0 * direction.twist.squaredNorm();
    EXPECT_NEAR(
        direction.prior_standard_deviation, 1.0 / std::sqrt(prior_precision), 1e-12);
    if (direction.twist == Vector6d(Vector6d::Unit(0))) {
      EXPECT_NEAR(direction.standard_deviation,
                  std::sqrt(covariance(0, 0) + covariance(1, 1)),
                  1e-12);
    }
    else if (direction.twist == Vector6d(Vector6d::Unit(0) + Vector6d::Unit(1))) {
      EXPECT_NEAR(direction.standard_deviation, std::sqrt(covariance(1, 1)), 1e-12);
    }
  }
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
  return dataReportOf(estimate, 100, 0.002).flags;
}

TEST(Report, FlagsAreRaisedBeyondTheirThresholds)
{
  using E = CalibratedEstimate;
  EXPECT_FALSE(flagsAfter([](E&) {}).any());
  // 20 standard deviations a metre along x.
  EXPECT_FALSE(flagsAfter([](E& e) { e.other_end[0] = 0.149; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.other_end[0] = 0.151; }).wrong_basin);
  EXPECT_FALSE(flagsAfter([](E& e) { e.scores.num_active = 25; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.scores.num_active = 24; }).low_support);
  EXPECT_FALSE(flagsAfter([](E& e) { e.kappa_inf = 3.83; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.kappa_inf = 3.85; }).few_patches);
  EXPECT_FALSE(flagsAfter([](E& e) { e.residual_scale = 1.99; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.residual_scale = 2.01; }).misfit);
  EXPECT_FALSE(flagsAfter([](E& e) { e.kappa_48 = e.kappa_inf = 9.9; }).any());
  EXPECT_TRUE(flagsAfter([](E& e) { e.kappa_48 = e.kappa_inf = 10.1; }).misfit);
}

TEST(Report, WhatIsNotANumberIsFlagged)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const DataFlags flags = flagsAfter([nan](CalibratedEstimate& e) {
    e.residual_scale = e.kappa_inf = e.other_end[0] = nan;
  });
  EXPECT_TRUE(flags.wrong_basin && flags.few_patches && flags.misfit);
}

} // namespace
} // namespace bayesian_icp
