// align() of the class with presets `exact` and `calibrated` (ICP and posterior)
// against PCL's ICP and GICP, all with their defaults and from the same guess, in real
// time. In `calibrated_on_pcls_tree` ICP searches in PCL's tree in place of ours.
//
//   align_benchmark source.pcd target.pcd [T_init.txt] [Google Benchmark options]
#include "benchmark_clouds.h"

#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include <benchmark/benchmark.h>

#include <cstdio>
#include <functional>

namespace {

using Point = pcl::PointXYZ;

struct Input {
  Cloud::Ptr source;
  Cloud::Ptr target;
  Eigen::Matrix4f guess;
};

/** One object a run: trees and covariances are part of the time. */
template <typename Registration>
void
align(benchmark::State& state,
      const Input& input,
      const std::function<void(Registration&)>& prepare)
{
  Cloud output;
  for (auto _ : state) {
    Registration registration;
    prepare(registration);
    registration.setInputSource(input.source);
    registration.setInputTarget(input.target);
    registration.align(output, input.guess);
    benchmark::DoNotOptimize(output.points.data());
  }
}

using BayesianIcp = pcl::BayesianIterativeClosestPoint<Point, Point>;

void
addBayesian(const Input& input,
            const std::string& name,
            const std::function<void(BayesianIcp&)>& prepare)
{
  for (const int num_threads : {1, 2})
    benchmark::RegisterBenchmark(
        (name + "/threads:" + std::to_string(num_threads)).c_str(),
        [=](benchmark::State& state) {
          align<BayesianIcp>(state, input, [=](BayesianIcp& icp) {
            prepare(icp);
            icp.setNumberOfThreads(static_cast<unsigned int>(num_threads));
          });
        })
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
}

void
addExact(const Input& input, const std::string& scale, double sigma, double n)
{
  addBayesian(input, "exact/" + scale, [=](BayesianIcp& icp) {
    icp.setPreset(bayesian_icp::Preset::Exact);
    icp.setMeasurementSigma(sigma);
    icp.setEffectivePoints(n);
  });
}

template <typename Registration>
void
addPcl(
    const char* name,
    const Input& input,
    const std::function<void(Registration&)>& prepare = [](Registration&) {})
{
  benchmark::RegisterBenchmark(
      name,
      [=](benchmark::State& state) { align<Registration>(state, input, prepare); })
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}

} // namespace

int
main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  Input input{Cloud::Ptr(new Cloud), Cloud::Ptr(new Cloud), readGuess("")};
  if (argc > 2)
    input = {
        readCloud(argv[1]), readCloud(argv[2]), readGuess(argc > 3 ? argv[3] : "")};
  if (input.source->empty() || input.target->empty()) {
    std::fprintf(stderr,
                 "Usage: %s source.pcd target.pcd [T_init.txt] [--benchmark_...]\n",
                 argv[0]);
    return 2;
  }
  std::printf("source %zu points, target %zu points\n",
              input.source->size(),
              input.target->size());
  using Icp = pcl::IterativeClosestPoint<Point, Point>;
  addPcl<Icp>("pcl_icp", input);
#if PCL_VERSION_COMPARE(>=, 1, 15, 0) // PCL's ICP has threads since
  addPcl<Icp>("pcl_icp/threads:2", input, [](Icp& icp) { icp.setNumberOfThreads(2); });
#endif
  addPcl<pcl::GeneralizedIterativeClosestPoint<Point, Point>>("pcl_gicp", input);
  addBayesian(input, "calibrated", [](BayesianIcp& icp) {
    icp.setPreset(bayesian_icp::Preset::Calibrated);
  });
  addBayesian(input, "calibrated_on_pcls_tree", [](BayesianIcp& icp) {
    icp.setPreset(bayesian_icp::Preset::Calibrated);
    icp.setSearchMethodTarget(pcl::make_shared<pcl::search::KdTree<Point>>());
  });
  addExact(input, "sigma:1,N:6000", 1.0, 6000.0);
  addExact(input, "sigma:0.0015,N:100", 0.0015, 100.0);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
