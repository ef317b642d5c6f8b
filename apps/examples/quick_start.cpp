// The quick start of README.md, as a program: quick_start source.pcd target.pcd
#include <pcl/io/pcd_io.h>
#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

#include <iostream>

int
main(int argc, char** argv)
{
  pcl::PointCloud<pcl::PointXYZ>::Ptr source(new pcl::PointCloud<pcl::PointXYZ>);
  pcl::PointCloud<pcl::PointXYZ>::Ptr target(new pcl::PointCloud<pcl::PointXYZ>);
  if (argc != 3 || pcl::io::loadPCDFile(argv[1], *source) < 0 ||
      pcl::io::loadPCDFile(argv[2], *target) < 0) {
    std::cerr << "Usage: " << argv[0] << " source.pcd target.pcd\n";
    return 2;
  }
  // [quick start]
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(source);
  icp.setInputTarget(target);
  pcl::PointCloud<pcl::PointXYZ> aligned;
  icp.align(aligned); // same result as IterativeClosestPoint, plus:
  std::cout << icp.getSummary().message << "\n"       // can you trust the posterior?
            << icp.getMean().transpose() << "\n"      // x y z [m], roll pitch yaw [rad]
            << icp.getCovariance() << "\n"            // 6x6, in the same order
            << icp.getSamples().rows() << " draws\n"; // each row is one pose
  // [/quick start]
  return icp.hasConverged() ? 0 : 1;
}
