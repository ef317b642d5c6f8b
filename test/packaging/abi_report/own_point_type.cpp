// The part of the report that is computed by the user's code: an own point type.
#define PCL_NO_PRECOMPILE

// PCL_ADD_POINT4D has anonymous structs.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#include "../consumer/echo_point.h"
#pragma GCC diagnostic pop
#include "report.h"

#include <pcl/registration/bayesian_icp.h>

void
reportOwnPointType()
{
  const auto source = scan<EchoPoint>(1, 300), target = scan<EchoPoint>(2, 1200);
  source->back().echo = 7;
  pcl::BayesianIterativeClosestPoint<EchoPoint, EchoPoint, double> registration;
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
