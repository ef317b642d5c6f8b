// Preset `exact` without ICP: its steps against the FLANN queries that they would need,
// its draws against Algorithm 1's, and how it scales; Algorithm 1's draws against their
// queries.
//
//   sampling_benchmark source.pcd target.pcd [T_target_source.txt] [Google Benchmark
//   options]
//
// The chains start about the given pose (identity without a file). Times are CPU time
// of all threads, but for the scaling in threads, which is in real time.
#include "../apps/io/clocks.h"
#include "benchmark_clouds.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <pcl/kdtree/kdtree_flann.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>

namespace {

using namespace bayesian_icp;

constexpr int num_steps = 1000;
constexpr int batch_size = 160;

/** Clouds, and the pose to start from. */
struct Pair {
  Eigen::Matrix3Xd source;
  std::shared_ptr<const KdTree> target;
  Vector6d guess;
};

struct Scale {
  const char* name;
  double sigma;
  double effective_points;
};

constexpr Scale scales[] = {{"sigma:0.0015,N:100", 0.0015, 100.0},
                            {"sigma:1,N:6000", 1.0, 6000.0}};

Options
makeOptions(Preset preset, const Scale& scale, int num_threads = 1)
{
  Options options;
  options.preset = preset;
  options.paper.scale = options.exact.scale = {scale.effective_points, scale.sigma};
  options.chains.num_threads = num_threads;
  Vector6d spread;
  spread << 0.05, 0.05, 0.05, 0.1, 0.1, 0.1;
  if (scale.sigma < 0.1)
    options.exact.initial_spread = spread;
  return options;
}

/** 1000 of them. */
PoseMatrix
drawsOf(const Pair& pair, const Scale& scale)
{
  Options options = makeOptions(Preset::Exact, scale);
  options.chains.num_draws = num_steps;
  return estimatePosterior(pair.source, *pair.target, pair.guess, options).samples;
}

/** The points that steps at these poses would look up: a random batch at each. */
Cloud
pointsOfSteps(const Pair& pair, const PoseMatrix& poses)
{
  Random random(1, 0);
  Cloud points;
  for (Eigen::Index step = 0; step < poses.rows(); ++step) {
    const Vector6d pose = poses.row(step).transpose();
    const Eigen::Matrix3d R = rotationOf(pose);
    for (int i = 0; i < batch_size; ++i) {
      const auto column = random.index(static_cast<std::size_t>(pair.source.cols()));
      const Eigen::Vector3f p =
          (R * pair.source.col(static_cast<Eigen::Index>(column)) + pose.head<3>())
              .cast<float>();
      points.emplace_back(p.x(), p.y(), p.z());
    }
  }
  return points;
}

/** Their neighbours by PCL's tree, nothing else. */
void
flannQueries(benchmark::State& state, const Pair& pair, const PoseMatrix& poses)
{
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(cloudOf(pair.target->points()));
  const Cloud points = pointsOfSteps(pair, poses);
  if (points.size() != num_steps * batch_size)
    state.SkipWithError("chains diverged");
  pcl::Indices index(1);
  std::vector<float> squared_distance(1);
  for (auto _ : state)
    for (const auto& point : points)
      tree.nearestKSearch(point, 1, index, squared_distance);
}

/** Seconds of CPU that the steps of one chain take, its warm-up left out. */
double
secondsOfSteps(const Pair& pair, Options options)
{
  // 999 steps are timed, between the callbacks of the first and the last one.
  options.exact.batch_size = batch_size;
  options.exact.thinning = 1;
  options.chains.num_chains = 1;
  options.chains.num_draws = num_steps;
  double begin = 0.0, end = 0.0;
  estimatePosterior(
      pair.source, *pair.target, pair.guess, options, [&](const Progress& progress) {
        if (progress.total_steps > 0)
          (begin == 0.0 ? begin : end) = io::cpuSeconds();
        return true;
      });
  return end - begin;
}

void
steps(benchmark::State& state, const Pair& pair, const Scale& scale)
{
  for (auto _ : state)
    state.SetIterationTime(secondsOfSteps(pair, makeOptions(Preset::Exact, scale)));
}

/** The whole estimate, and how much it is worth. */
void
draws(benchmark::State& state, const Pair& pair, const Options& options)
{
  double min_ess = 0.0;
  for (auto _ : state) {
    const auto estimate =
        estimatePosterior(pair.source, *pair.target, pair.guess, options);
    min_ess = std::numeric_limits<double>::infinity();
    for (const auto& coordinate : estimate.summary.coordinates)
      min_ess = std::min(min_ess, coordinate.bulk_ess);
    if (estimate.samples.rows() == 0)
      state.SkipWithError(estimate.summary.message.c_str());
  }
  using Rate = benchmark::Counter;
  state.counters["draws_per_second"] =
      Rate(options.chains.num_draws, Rate::kIsIterationInvariantRate);
  state.counters["min_ess"] = min_ess;
  state.counters["min_ess_per_second"] = Rate(min_ess, Rate::kIsIterationInvariantRate);
}

benchmark::internal::Benchmark*
add(const std::string& name, const std::function<void(benchmark::State&)>& function)
{
  return benchmark::RegisterBenchmark(name.c_str(), function)
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}

void
addComparisons(const Pair& pair)
{
  for (const Scale& scale : scales)
    add(std::string("flann/160000_queries/") + scale.name,
        [&](benchmark::State& s) { flannQueries(s, pair, drawsOf(pair, scale)); });
  for (const Scale& scale : scales)
    add(std::string("exact/1000_steps_of_160/") + scale.name, [&](benchmark::State& s) {
      steps(s, pair, scale);
    })->UseManualTime();
  for (const Scale& scale : scales)
    add(std::string("exact/2000_draws/") + scale.name, [&](benchmark::State& s) {
      draws(s, pair, makeOptions(Preset::Exact, scale));
    });
  for (const double step_size : {1e-4, 1e-5, 1e-6})
    add("paper/2000_draws/sigma:1,N:6000/alpha:" + std::to_string(step_size),
        [&pair, step_size](benchmark::State& s) {
          Options options = makeOptions(Preset::Paper, scales[1]);
          options.paper.sgld.step_size = step_size;
          draws(s, pair, options);
        });
}

/** Draws of Algorithm 1 against the queries that they need. */
void
addAlgorithm1(const Pair& pair)
{
  add("algorithm_1/160000_flann_queries", [&](benchmark::State& s) {
    flannQueries(s, pair, pair.guess.transpose().replicate(num_steps, 1));
  });
  add("algorithm_1/1000_draws_of_160", [&](benchmark::State& s) {
    Options options = makeOptions(Preset::Paper, scales[1]);
    options.chains.num_draws = num_steps;
    options.paper.batch_size = batch_size;
    // At the usual step the chains stay near the surface no better than the queries do;
    // a small one keeps both on the same kind of query.
    options.paper.sgld.step_size = 1e-6;
    draws(s, pair, options);
  });
}

void
addScaling(const Pair& pair)
{
  for (const int threads : {1, 2})
    add("scaling/threads:" + std::to_string(threads),
        [&pair, threads](benchmark::State& s) {
          draws(s, pair, makeOptions(Preset::Exact, scales[0], threads));
        })
        ->UseRealTime();
  for (const int num_draws : {500, 2000, 8000})
    add("scaling/draws:" + std::to_string(num_draws),
        [&pair, num_draws](benchmark::State& s) {
          Options options = makeOptions(Preset::Exact, scales[0]);
          options.chains.num_draws = num_draws;
          draws(s, pair, options);
        });
  for (const Eigen::Index size : {500, 2000, 8000, 32000})
    add("scaling/source:" + std::to_string(size), [&pair, size](benchmark::State& s) {
      const Eigen::Matrix3Xf points = pair.source.cast<float>();
      const Pair other{resized(points, size).cast<double>(), pair.target, pair.guess};
      draws(s, other, makeOptions(Preset::Exact, scales[0]));
    });
  for (const Eigen::Index size : {5000, 50000, 270000, 1400000})
    add("scaling/1000_steps_of_160/target:" + std::to_string(size),
        [&pair, size](benchmark::State& s) {
          const Pair other{
              pair.source,
              std::make_shared<KdTree>(resized(pair.target->points(), size)),
              pair.guess};
          steps(s, other, scales[0]);
        })
        ->UseManualTime();
}

} // namespace

int
main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  if (argc < 3) {
    std::fprintf(stderr,
                 "Usage: %s source.pcd target.pcd [T_target_source.txt] "
                 "[--benchmark_...]\n",
                 argv[0]);
    return 2;
  }
  const Cloud::Ptr source = readCloud(argv[1]), target = readCloud(argv[2]);
  const Eigen::Matrix4f guess = readGuess(argc > 3 ? argv[3] : "");
  const Pair pair{pointsOf(*source).cast<double>(),
                  std::make_shared<KdTree>(pointsOf(*target)),
                  poseOf(guess.cast<double>())};
  addComparisons(pair);
  addAlgorithm1(pair);
  addScaling(pair);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
