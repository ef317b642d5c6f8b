// Uses the class with a point type that PCL has never heard of.
#define PCL_NO_PRECOMPILE

#include "echo_point.h"
#include "surface.h"

#include <pcl/registration/bayesian_icp.h>

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
