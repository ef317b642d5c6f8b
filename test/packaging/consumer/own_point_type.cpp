// Uses the class with a point type that PCL has never heard of.
#define PCL_NO_PRECOMPILE

#include "echo_point.h"
#include "report.h"
#include "surface.h"

#include <pcl/registration/bayesian_icp.h>

using Registration = pcl::BayesianIterativeClosestPoint<EchoPoint, EchoPoint, double>;

bool
registersOwnPointType()
{
  const ScanPair<EchoPoint> scans;
  scans.source->front().echo = 3;
  Registration registration;
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

void
reportOwnPointType()
{
  const auto source = scan<EchoPoint>(1, 300), target = scan<EchoPoint>(2, 1200);
  source->back().echo = 7;
  Registration registration;
  registration.setInputSource(source);
  registration.setInputTarget(target);
  pcl::PointCloud<EchoPoint> output;
  using bayesian_icp::Preset;
  for (const auto preset : {Preset::Calibrated, Preset::Exact, Preset::Paper}) {
    registration.setOptions(reportOptions(preset));
    registration.align(output);
    std::cout << "own point type, echo " << output.back().echo << '\n';
    printPosterior(toString(preset), registration);
  }
}
