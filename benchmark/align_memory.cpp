// Peak memory of one align() in a process of its own, from /proc/self/status:
//
//   align_memory {none|icp|gicp|paper|exact|calibrated} source.pcd target.pcd
//   [T_init.txt]
//
// `none` only reads the clouds: what to subtract. Prints kB (VmHWM).
#include "benchmark_clouds.h"

#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <string>

namespace {

using Point = pcl::PointXYZ;

const std::map<std::string, bayesian_icp::Preset> presets = {
    {"paper", bayesian_icp::Preset::Paper},
    {"exact", bayesian_icp::Preset::Exact},
    {"calibrated", bayesian_icp::Preset::Calibrated}};

template <typename Registration>
void
align(Registration&& registration, int argc, char** argv)
{
  registration.setInputSource(readCloud(argv[2]));
  registration.setInputTarget(readCloud(argv[3]));
  Cloud output;
  registration.align(output, readGuess(argc > 4 ? argv[4] : ""));
}

void
printPeak(const std::string& name)
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0)
      std::printf("%s %s\n", name.c_str(), line.c_str());
}

} // namespace

int
main(int argc, char** argv)
{
  const std::string method = argc > 3 ? argv[1] : "";
  if (method == "icp")
    align(pcl::IterativeClosestPoint<Point, Point>(), argc, argv);
  else if (method == "gicp")
    align(pcl::GeneralizedIterativeClosestPoint<Point, Point>(), argc, argv);
  else if (presets.count(method) > 0) {
    pcl::BayesianIterativeClosestPoint<Point, Point> icp;
    icp.setPreset(presets.at(method));
    align(icp, argc, argv);
  }
  else if (method == "none") {
    const Cloud::Ptr source = readCloud(argv[2]), target = readCloud(argv[3]);
    std::printf("%zu and %zu points\n", source->size(), target->size());
  }
  else {
    std::fprintf(stderr,
                 "Usage: %s {none|icp|gicp|paper|exact|calibrated} source.pcd "
                 "target.pcd [T_init.txt]\n",
                 argv[0]);
    return 2;
  }
  printPeak(method);
  return 0;
}
