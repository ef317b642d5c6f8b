// What the data say in words: motions and flags.
#include <bayesian_icp/data_report.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

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
  report.active_fraction_of_target = 0.8;
  report.effective_patches = 80.0;
  report.residual_scale = 1.0;
  report.correlation_factor = 1.2;
  return report;
}

TEST(DescribeFlags, NameNumberAndThreshold)
{
  EXPECT_TRUE(describeFlags(goodReport()).empty());
  DataReport report = goodReport();
  report.flags = {true, true, true, true, true};
  report.directions.resize(6);
  for (DataDirection& direction : report.directions) {
    direction.standard_deviation = 0.995;
    direction.prior_standard_deviation = 1.0;
  }
  report.other_cost_ratio = 1.02;
  report.basin_distance = 5.25;
  report.active_fraction = 0.09;
  report.active_fraction_of_target = 0.2;
  report.effective_patches = 12.0;
  report.residual_scale = 12.6;
  report.correlation_factor = 14.0;
  const auto texts = describeFlags(report);
  ASSERT_EQ(texts.size(), 5u);
  const char* parts[5][2] = {{"5.2 ", "at most 3"},
                             {"9 %", "40 %"},
                             {"12 ", "at least 28"},
                             {"12.6 ", "at most 10"},
                             {"99.5 %", "99 %"}};
  for (std::size_t i = 0; i < 5; ++i)
    for (const char* part : parts[i])
      EXPECT_NE(texts[i].find(part), std::string::npos) << texts[i];
}

TEST(DescribeSupport, SaysThatTheTargetIsNotCompared)
{
  DataReport report = goodReport();
  EXPECT_EQ(
      describeSupport(report),
      "90 % of the source points lie on the target's surface, 80 % of the target's "
      "on the source's");
  report.active_fraction_of_target = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(
      describeSupport(report),
      "90 % of the source points lie on the target's surface, the target's points "
      "are not compared");
  EXPECT_FALSE(flagsOf(report).low_support);
  report.active_fraction = 0.1;
  EXPECT_TRUE(flagsOf(report).low_support);
}

} // namespace
} // namespace bayesian_icp
