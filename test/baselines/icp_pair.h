// A pair of data/ for the tests of ICP, and PCL's ICP on it.
#pragma once

#include "baselines/iterative_closest_point.h"

#include <pcl/io/pcd_io.h>
#include <pcl/registration/icp.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <string>

namespace bayesian_icp {
namespace test {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/** PCL's ICP in double, which moves its cloud in float all the same. */
class PclIcp : public pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double> {
public:
  int
  numIterations() const
  {
    return nr_iterations_;
  }
};

/** PCL's state for each of our ends. */
inline int
pclStateOf(IcpStop stop)
{
  using Criteria = pcl::registration::DefaultConvergenceCriteria<double>;
  switch (stop) {
  case IcpStop::TooFewPairs:
    return Criteria::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES;
  case IcpStop::MaxIterations:
    return Criteria::CONVERGENCE_CRITERIA_ITERATIONS;
  case IcpStop::Transformation:
    return Criteria::CONVERGENCE_CRITERIA_TRANSFORM;
  case IcpStop::AbsoluteFitness:
    return Criteria::CONVERGENCE_CRITERIA_ABS_MSE;
  case IcpStop::RelativeFitness:
    return Criteria::CONVERGENCE_CRITERIA_REL_MSE;
  }
  return -1;
}

inline Eigen::Matrix3Xf
matrixOfCloud(const Cloud& cloud)
{
  return cloud.getMatrixXfMap().topRows<3>();
}

/** Two clouds in PCL's form and in ours. */
struct IcpPair {
  Cloud::Ptr source_cloud;
  Cloud::Ptr target_cloud;
  Eigen::Matrix3Xd source;
  KdTree target;

  IcpPair(const Cloud::Ptr& source_points, const Cloud::Ptr& target_points)
  : source_cloud(source_points)
  , target_cloud(target_points)
  , source(matrixOfCloud(*source_points).cast<double>())
  , target(matrixOfCloud(*target_points))
  {}

  void
  setUp(PclIcp& icp, const IcpOptions& options) const
  {
    icp.setInputSource(source_cloud);
    icp.setInputTarget(target_cloud);
    icp.setMaximumIterations(options.max_iterations);
    if (std::isfinite(options.max_distance))
      icp.setMaxCorrespondenceDistance(options.max_distance);
    icp.setTransformationEpsilon(options.transformation_epsilon);
    // PCL 1.13 takes the other epsilon's where there is none, and later ones 0.99999.
    icp.setTransformationRotationEpsilon(options.rotation_epsilon > 0.0
                                             ? options.rotation_epsilon
                                             : 1.0 - options.transformation_epsilon);
    icp.setEuclideanFitnessEpsilon(options.euclidean_fitness_epsilon);
    icp.getConvergeCriteria()->setAbsoluteMSE(options.absolute_fitness_epsilon);
  }

  /** PCL's run, in our words. */
  IcpResult
  runPcl(const Eigen::Isometry3d& start, const IcpOptions& options) const
  {
    PclIcp icp;
    setUp(icp, options);
    Cloud moved;
    icp.align(moved, start.matrix());
    IcpResult result;
    result.T_target_source = Eigen::Isometry3d(icp.getFinalTransformation());
    result.num_iterations = icp.numIterations();
    result.has_converged = icp.hasConverged();
    for (const IcpStop stop : icp_stops)
      if (pclStateOf(stop) == icp.getConvergeCriteria()->getConvergenceState())
        result.stop = stop;
    return result;
  }

  IcpResult
  run(const Eigen::Isometry3d& start, const IcpOptions& options) const
  {
    return iterativeClosestPoint(source, target, start, options);
  }
};

/** A pair of data/, both clouds thinned to every \p step-th point. */
inline IcpPair
readIcpPair(const std::string& name, std::size_t step)
{
  const auto read = [&](const std::string& file) {
    Cloud all;
    EXPECT_EQ(pcl::io::loadPCDFile(BAYESIAN_ICP_DATA_DIR "/" + name + "/" + file, all),
              0);
    const auto thinned = pcl::make_shared<Cloud>();
    for (std::size_t i = 0; i < all.size(); i += step)
      thinned->push_back(all[i]);
    return thinned;
  };
  return {read("source.pcd"), read("target.pcd")};
}

} // namespace test
} // namespace bayesian_icp
