// 1000 draws of Algorithm 1 against the nearest-neighbour queries that they need, on
// one thread: draws_benchmark source.pcd target.pcd [Google Benchmark options]
#include <bayesian_icp/random.h>

#include <pcl/io/pcd_io.h>
#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

#include <benchmark/benchmark.h>

#include <cstdio>

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr int num_draws = 1000;
constexpr int batch_size = 160;

/** Queries of source points, in random order as in a mini-batch, to PCL's tree. */
void
flannQueries(benchmark::State& state,
             const Cloud::Ptr& source,
             const Cloud::Ptr& target)
{
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(target);
  bayesian_icp::Random random(1, 0);
  pcl::Indices index(1);
  std::vector<float> squared_distance(1);
  for (auto _ : state)
    for (int i = 0; i < num_draws * batch_size; ++i)
      tree.nearestKSearch(
          (*source)[random.index(source->size())], 1, index, squared_distance);
}

/** The chains alone: correspondences by the class's search tree, as it has them. */
void
draws(benchmark::State& state, const Cloud::Ptr& source, const Cloud::Ptr& target)
{
  const auto tree =
      pcl::make_shared<pcl::bayesian_icp_detail::SeededKdTree<pcl::PointXYZ>>();
  tree->setInputCloud(target);
  const pcl::bayesian_icp_detail::KdTreeSearch<pcl::PointXYZ, pcl::PointXYZ> search(
      tree, target, std::sqrt(std::numeric_limits<double>::max()), nullptr);
  const Eigen::Matrix3Xd points = pcl::bayesian_icp_detail::pointMatrix(*source);
  bayesian_icp::Options options;
  options.preset = bayesian_icp::Preset::Paper;
  options.chains.num_draws = num_draws;
  options.chains.num_threads = 1;
  options.paper.batch_size = batch_size;
  // At the usual step the chains stay near the surface no better than the queries do; a
  // small one keeps both on the same kind of query.
  options.paper.sgld.step_size = 1e-6;
  for (auto _ : state)
    benchmark::DoNotOptimize(bayesian_icp::estimatePosterior(
        points, search, bayesian_icp::Vector6d::Zero(), options));
}

} // namespace

int
main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  const Cloud::Ptr source(new Cloud), target(new Cloud);
  if (argc != 3 || pcl::io::loadPCDFile(argv[1], *source) < 0 ||
      pcl::io::loadPCDFile(argv[2], *target) < 0) {
    std::fprintf(
        stderr, "Usage: %s source.pcd target.pcd [--benchmark_...]\n", argv[0]);
    return 2;
  }
  benchmark::RegisterBenchmark("160000_flann_queries", flannQueries, source, target)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("1000_draws_of_160", draws, source, target)
      ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
