// Uses the class with a point type that PCL has never heard of.
#define PCL_NO_PRECOMPILE

#include "surface.h"

#include <pcl/registration/bayesian_icp.h>
#include <pcl/pcl_macros.h>
#include <pcl/register_point_struct.h>

#include <cstdint>

struct EchoPoint {
  PCL_ADD_POINT4D;
  std::uint16_t echo;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};
POINT_CLOUD_REGISTER_POINT_STRUCT(
    EchoPoint, (float, x, x)(float, y, y)(float, z, z)(std::uint16_t, echo, echo))

bool
registersOwnPointType()
{
  const ScanPair<EchoPoint> scans;
  scans.source->front().echo = 3;
  pcl::BayesianIterativeClosestPoint<EchoPoint, EchoPoint, double> registration;
  registration.setInputSource(scans.source);
  registration.setInputTarget(scans.target);
  registration.setMaximumIterations(50);
  registration.setPreset(bayesian_icp::Preset::Paper);
  registration.setNumberOfSamples(100);
  pcl::PointCloud<EchoPoint> output;
  registration.align(output);

  const Eigen::Matrix4d truth = scans.T_target_source.matrix().cast<double>();
  return expect(registration.getFinalTransformation().isApprox(truth, 1e-4),
                "the true pose, own point type") &&
         expect(output.front().echo == 3, "own fields are kept") &&
         expect(registration.getSamples().rows() == 100, "100 draws");
}
