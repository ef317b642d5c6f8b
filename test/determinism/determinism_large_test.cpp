// The same numbers to the last bit for any number of threads with clouds so large that
// trees are built, and the pairs of ICP searched, by several threads, end to end.
#include "determinism_runs.h"
#include "support/registration_support.h"

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

namespace bayesian_icp::test {
namespace {

TEST(DeterminismLarge, NumberOfThreadsChangesNoBit)
{
  // A thread for every 50 000 points of a tree, and several from 32 768 queries on.
  const auto source = pcl::test::cloudOf(wavySurface(96, 40000)),
             target = pcl::test::cloudOf(wavySurface(97, 400000));
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(source);
  icp.setNumberOfSamples(40);
  const pcl::test::QuietConsole quiet;
  RunRecord reference;
  Eigen::Matrix4f reference_transformation;
  for (const unsigned int num_threads : {1, 2, 3, 8}) {
    icp.setNumberOfThreads(num_threads);
    icp.setInputTarget(target); // a new tree
    pcl::PointCloud<pcl::PointXYZ> output;
    icp.align(output);
    const RunRecord record = recordOf({icp.getSummary(), {}, icp.getSamples()});
    ASSERT_EQ(icp.getSamples().rows(), 40) << icp.getSummary().message;
    if (num_threads == 1) {
      reference = record;
      reference_transformation = icp.getFinalTransformation();
    }
    EXPECT_EQ(reference_transformation, icp.getFinalTransformation())
        << num_threads << " threads";
    EXPECT_TRUE(areIdentical(reference, record))
        << num_threads << " threads: " << difference(reference, record) << " units";
  }
}

} // namespace
} // namespace bayesian_icp::test
