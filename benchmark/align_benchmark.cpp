// align() of the class against PCL's ICP and GICP, all with their defaults and from the
// same guess, in real time and in processor time:
//
//   align_benchmark FOLDER... [Google Benchmark options]
//
// A folder has source.pcd, target.pcd and, optionally, the guess T_init.txt; or scans,
// of which the second is registered to the first. Names of the benchmarks:
//
//   first       a new object for each align(), so that everything is made anew
//   next        another source for an object that has the target already: in turn the
//               source and the source less its last point
//   mean        with setUseMeanAsFinalTransformation(true): the posterior without ICP
//   pcls_tree   ICP searches in PCL's tree in place of ours
//   gate        preset exact with a gate [m]
//   tukey       preset exact with a kernel that is flat beyond its width [m]
#include "benchmark_clouds.h"

#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

using Point = pcl::PointXYZ;

struct Input {
  std::string name;
  Cloud::Ptr source;
  Cloud::Ptr target;
  Eigen::Matrix4f guess;
};

Input
readInput(fs::path folder)
{
  if (folder.filename().empty()) // a slash at the end
    folder = folder.parent_path();
  std::string source = folder / "source.pcd", target = folder / "target.pcd";
  if (!fs::exists(source)) {
    const std::vector<std::string> scans = scansIn(folder);
    if (scans.size() >= 2) {
      target = scans[0];
      source = scans[1];
    }
  }
  const fs::path guess = folder / "T_init.txt";
  return {folder.filename().string(),
          readCloud(source),
          readCloud(target),
          readGuess(fs::exists(guess) ? guess.string() : "")};
}

template <typename Registration>
using Prepare = std::function<void(Registration&)>;

/** A new object for each run, so that trees and covariances are part of the time, or
 * one object for all runs, whose target is set once. It knows the last source again, so
 * it gets another one each time. */
enum class Objects { New, One };

template <typename Registration>
void
align(benchmark::State& state,
      const Input& input,
      Objects objects,
      const Prepare<Registration>& prepare)
{
  Cloud output;
  Cloud::Ptr source = input.source, next_source(new Cloud(*source));
  next_source->erase(next_source->end() - 1);
  std::optional<Registration> registration;
  const auto alignOnce = [&] {
    if (!registration) {
      prepare(registration.emplace());
      registration->setInputTarget(input.target);
    }
    registration->setInputSource(source);
    registration->align(output, input.guess);
    source.swap(next_source);
    benchmark::DoNotOptimize(output.points.data());
  };
  if (objects == Objects::One)
    alignOnce();
  for (auto _ : state) {
    if (objects == Objects::New)
      registration.reset();
    alignOnce();
  }
}

template <typename Registration>
void
add(
    const std::string& name,
    const Input& input,
    Objects objects,
    const Prepare<Registration>& prepare = [](Registration&) {})
{
  benchmark::RegisterBenchmark(
      (input.name + "/" + name).c_str(),
      [=](benchmark::State& state) { align(state, input, objects, prepare); })
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}

using Icp = pcl::IterativeClosestPoint<Point, Point>;
using BayesianIcp = pcl::BayesianIterativeClosestPoint<Point, Point>;

/** With one thread and with two. */
void
addBayesian(
    const std::string& name,
    const Input& input,
    Objects objects,
    const Prepare<BayesianIcp>& prepare = [](BayesianIcp&) {})
{
  for (const int num_threads : {1, 2})
    add<BayesianIcp>(name + "/threads:" + std::to_string(num_threads),
                     input,
                     objects,
                     [=](BayesianIcp& icp) {
                       prepare(icp);
                       icp.setNumberOfThreads(static_cast<unsigned int>(num_threads));
                     });
}

Prepare<BayesianIcp>
exactWith(double sigma, double n, const bayesian_icp::ResidualOptions& residual = {})
{
  return [=](BayesianIcp& icp) {
    bayesian_icp::Options options = icp.getOptions();
    options.preset = bayesian_icp::Preset::Exact;
    options.exact.residual = residual;
    icp.setOptions(options);
    icp.setMeasurementSigma(sigma);
    icp.setEffectivePoints(n);
  };
}

void
addAll(const Input& input)
{
  add<Icp>("pcl_icp", input, Objects::New);
#if PCL_VERSION_COMPARE(>=, 1, 15, 0) // PCL's ICP has threads since
  add<Icp>("pcl_icp/threads:2", input, Objects::New, [](Icp& icp) {
    icp.setNumberOfThreads(2);
  });
#endif
  add<pcl::GeneralizedIterativeClosestPoint<Point, Point>>(
      "pcl_gicp", input, Objects::New);
  const Prepare<BayesianIcp> mean = [](BayesianIcp& icp) {
    icp.setUseMeanAsFinalTransformation(true);
  };
  addBayesian("calibrated/first", input, Objects::New);
  addBayesian("calibrated/next", input, Objects::One);
  addBayesian("calibrated/mean/first", input, Objects::New, mean);
  addBayesian("calibrated/mean/next", input, Objects::One, mean);
  addBayesian("calibrated/pcls_tree", input, Objects::New, [](BayesianIcp& icp) {
    icp.setSearchMethodTarget(pcl::make_shared<pcl::search::KdTree<Point>>());
  });
  addBayesian("paper", input, Objects::New, [](BayesianIcp& icp) {
    icp.setPreset(bayesian_icp::Preset::Paper);
  });
  addBayesian("exact/sigma:1,N:6000", input, Objects::New, exactWith(1.0, 6000.0));
  addBayesian(
      "exact/sigma:0.0015,N:100", input, Objects::New, exactWith(0.0015, 100.0));
  constexpr double limit = 0.3; // [m]
  bayesian_icp::ResidualOptions gate, kernel;
  gate.max_distance = limit;
  kernel.kernel = bayesian_icp::RobustKernel::Tukey;
  kernel.kernel_width = limit;
  addBayesian("exact/gate:0.3", input, Objects::New, exactWith(1.0, 6000.0, gate));
  addBayesian("exact/tukey:0.3", input, Objects::New, exactWith(1.0, 6000.0, kernel));
}

} // namespace

int
main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  if (argc < 2) {
    std::fprintf(stderr, "Usage: %s FOLDER... [--benchmark_...]\n", argv[0]);
    return 2;
  }
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      std::fprintf(stderr, "%s: %s is not a folder\n", argv[0], argv[i]);
      return 1;
    }
    const Input input = readInput(argv[i]);
    std::printf("%s: source %zu points, target %zu points\n",
                input.name.c_str(),
                input.source->size(),
                input.target->size());
    addAll(input);
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
