// What the data say: motions in words, flags and their thresholds, the report of an
// estimate.
#include <bayesian_icp/calibration/calibrated_report.h>
#include <bayesian_icp/data_report.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace {

const Eigen::Vector3d centre(1.0, 2.0, 3.0);

Vector6d
twistOf(const Eigen::Vector3d& v, const Eigen::Vector3d& w)
{
  Vector6d twist;
  twist << v, w;
  return twist;
}

/** The twist about centre of a turn about an axis through a point. */
Vector6d
turnAbout(const Eigen::Vector3d& axis, const Eigen::Vector3d& point, double pitch = 0.0)
{
  return twistOf(axis.cross(centre - point) + pitch * axis, axis);
}

TEST(DescribeTwist, Translations)
{
  const Eigen::Vector3d v = Eigen::Vector3d(0.98, 0.1, 0.1).normalized();
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  EXPECT_EQ(describeTwist(twistOf(v, none), centre),
            "translation along (0.99, 0.10, 0.10)");
  EXPECT_EQ(describeTwist(twistOf(-v, none), centre),
            "translation along (0.99, 0.10, 0.10)");
  // Components that round to nothing have no sign.
  EXPECT_EQ(describeTwist(twistOf(Eigen::Vector3d(-1e-3, -4e-3, 1.0), none), centre),
            "translation along (0.00, 0.00, 1.00)");
  EXPECT_EQ(describeTwist(Vector6d::Zero(), centre), "no motion");
}

TEST(DescribeTwist, TurnsThroughThePointOfTheAxisNearestToTheCentre)
{
  // An upright axis: the nearest point has the centre's height, wherever the axis was
  // said to pass.
  const Eigen::Vector3d up(0.0, 0.0, 4.0);
  for (const double height : {-7.0, 0.0, 3.0}) {
    const Eigen::Vector3d point(1.1, 2.05, height);
    const std::string text = "rotation about (0.00, 0.00, 1.00) through (1.100, 2.050, "
                             "3.000) m";
    EXPECT_EQ(describeTwist(turnAbout(up, point), centre), text);
    EXPECT_EQ(describeTwist(-turnAbout(up, point), centre), text);
  }
}

TEST(DescribeTwist, ScrewsHaveAPitchWhateverTheirSign)
{
  const Eigen::Vector3d axis(0.0, -2.0, 0.0), point(1.0, 0.0, 3.1);
  const std::string text = "screw about (0.00, 1.00, 0.00) through (1.000, 2.000, "
                           "3.100) m with a pitch of 0.250 m/rad";
  EXPECT_EQ(describeTwist(turnAbout(axis, point, 0.25), centre), text);
  EXPECT_EQ(describeTwist(-turnAbout(axis, point, 0.25), centre), text);
  EXPECT_EQ(describeTwist(turnAbout(axis, point, 0.05), centre).rfind("rotation", 0),
            0u);
}

TEST(DescribeTwist, AFarAxisIsATranslation)
{
  // Displacement of the centre 0.98, the rest of the unit comes from the turn.
  const Eigen::Vector3d v(0.0, 0.98, 0.0), w(0.0, 0.0, 0.1);
  EXPECT_EQ(describeTwist(twistOf(v, w), centre),
            "translation along (0.00, 1.00, 0.00)");
  EXPECT_EQ(describeTwist(twistOf(0.9 * v, w), centre).rfind("rotation", 0), 0u);
}

/** A report without flags. */
DataReport
goodReport()
{
  DataReport report;
  report.is_available = true;
  report.basin_distance = 0.1;
  report.active_fraction = 0.9;
  report.effective_patches = 80.0;
  report.residual_scale = 1.0;
  report.correlation_factor = 1.2;
  return report;
}

TEST(DescribeFlags, NameNumberAndThreshold)
{
  EXPECT_TRUE(describeFlags(goodReport()).empty());
  DataReport report = goodReport();
  report.flags = {true, true, true, true};
  report.basin_distance = 5.25;
  report.active_fraction = 0.09;
  report.effective_patches = 12.0;
  report.residual_scale = 2.6;
  report.correlation_factor = 14.0;
  const auto texts = describeFlags(report);
  ASSERT_EQ(texts.size(), 4u);
  const char* parts[4][2] = {{"5.2 ", "at most 3"},
                             {"9 %", "25 %"},
                             {"12 ", "at least 30"},
                             {"2.6 ", "14.0 "}};
  for (std::size_t i = 0; i < 4; ++i)
    for (const char* part : parts[i])
      EXPECT_NE(texts[i].find(part), std::string::npos) << texts[i];
}

TEST(DescribeFlags, MisfitTellsWhichOfItsTwoReasons)
{
  DataReport report = goodReport();
  report.flags.misfit = true;
  report.correlation_factor = 11.0;
  const std::string text = describeFlags(report).at(0);
  EXPECT_NE(text.find("11.0"), std::string::npos);
  EXPECT_EQ(text.find("residuals"), std::string::npos);
}

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

TEST(Report, DeviationsAlongObliqueDirectionsAreThoseOfTheirCoordinates)
{
  CalibratedEstimate estimate = diagonalEstimate();
  estimate.directions(0, 1) = 1.0; // the second direction leans towards the first
  const DataReport report = dataReportOf(estimate, 100, 0.002);
  // Coordinates c of xi = V c: c_1 = xi_1, c_0 = xi_0 - xi_1.
  const auto& covariance = estimate.covariance;
  for (const DataDirection& direction : report.directions) {
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

/** The estimate of goodReport(), more or less. */
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
