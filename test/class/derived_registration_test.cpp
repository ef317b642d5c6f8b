// Users derive from pcl::IterativeClosestPoint and override its virtual functions: what
// stands in for it lets them.
#include "support/registration_support.h"

#include <pcl/registration/stochastic_gradient_icp.h>

#include <gtest/gtest.h>

namespace pcl {
namespace test {
namespace {

/** Counts the calls of every protected virtual function of PCL's ICP. */
template <typename Registration>
class Derived : public Registration {
public:
  using typename Registration::Matrix4;
  using typename Registration::PointCloudSource;

  int num_runs = 0, num_moves = 0, num_blob_checks = 0;
  /** Added to every guess. */
  Eigen::Vector3f shift = Eigen::Vector3f::Zero();

protected:
  void
  computeTransformation(PointCloudSource& output, const Matrix4& guess) override
  {
    ++num_runs;
    Matrix4 shifted = guess;
    shifted.template topRightCorner<3, 1>() += shift;
    Registration::computeTransformation(output, shifted);
  }

  void
  transformCloud(const PointCloudSource& input,
                 PointCloudSource& output,
                 const Matrix4& transformation) override
  {
    ++num_moves;
    Registration::transformCloud(input, output, transformation);
  }

  void
  determineRequiredBlobData() override
  {
    ++num_blob_checks;
    Registration::determineRequiredBlobData();
  }
};

template <typename Registration>
class DerivedRegistration : public ::testing::Test {};

using Registrations = ::testing::Types<
    BayesianIcp,
    StochasticGradientDescentIterativeClosestPoint<PointXYZ, PointXYZ>>;
TYPED_TEST_SUITE(DerivedRegistration, Registrations, );

TYPED_TEST(DerivedRegistration, OverridesAreCalled)
{
  const Scans<PointXYZ> scans;
  const QuietConsole quiet;
  Derived<TypeParam> derived;
  // As programs hold it that know PCL's class.
  Icp& icp = derived;
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  Cloud output;
  icp.align(output);
  EXPECT_EQ(derived.num_runs, 1);
  EXPECT_GT(derived.num_moves, 0);
  EXPECT_GT(derived.num_blob_checks, 0);
  EXPECT_TRUE(icp.hasConverged());
}

TYPED_TEST(DerivedRegistration, AnOverrideMayChangeWhatIsComputed)
{
  const Scans<PointXYZ> scans;
  const QuietConsole quiet;
  const Eigen::Vector3f shift(0.02f, -0.01f, 0.03f);
  Derived<TypeParam> derived;
  derived.shift = shift;
  TypeParam plain;
  Cloud output;
  for (Icp* icp : {static_cast<Icp*>(&derived), static_cast<Icp*>(&plain)}) {
    icp->setInputSource(scans.source);
    icp->setInputTarget(scans.target);
  }
  derived.align(output);
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  guess.topRightCorner<3, 1>() = shift;
  plain.align(output, guess);
  EXPECT_EQ(derived.getFinalTransformation(), plain.getFinalTransformation());
  plain.align(output);
  EXPECT_NE(derived.getFinalTransformation(), plain.getFinalTransformation());
}

} // namespace
} // namespace test
} // namespace pcl
