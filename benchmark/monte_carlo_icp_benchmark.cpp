// What a run of ICP to completion costs, ours and PCL's, from the same starts in the
// same process, and what 10 000 of ours would: monte_carlo_icp_benchmark FOLDER [RUNS
// [PCL_RUNS]], FOLDER with source.pcd and target.pcd.
//
// Processor time, so that other work of the machine matters less; every run is timed by
// itself, which gives the standard error of their mean.
#include "../apps/io/clocks.h"
#include "baselines/monte_carlo_icp.h"
#include "benchmark_clouds.h"
#include "geometry/twist.h"

#include <pcl/registration/icp.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using namespace bayesian_icp;

constexpr double num_paper_runs = 10000.0;

struct Mean {
  double value = 0.0;
  double standard_error = 0.0;
};

Mean
meanOf(const std::vector<double>& values)
{
  const auto count = static_cast<Eigen::Index>(values.size());
  const Eigen::Map<const Eigen::ArrayXd> all(values.data(), count);
  const double variance = (all - all.mean()).square().mean();
  return {all.mean(), std::sqrt(variance / std::max(1.0, double(count) - 1.0))};
}

/** Seconds of our runs [0, num_runs). */
std::vector<double>
timeOurs(const Eigen::Matrix3Xd& source,
         const KdTree& target,
         int num_runs,
         std::vector<MonteCarloIcpRun>& runs)
{
  std::vector<double> seconds;
  MonteCarloIcpOptions options;
  options.num_runs = 1;
  options.num_threads = 1;
  for (int i = 0; i < num_runs; ++i) {
    options.first_run = i;
    const double begin = io::cpuSeconds();
    runs.push_back(monteCarloIcp(source, target, options).front());
    seconds.push_back(io::cpuSeconds() - begin);
  }
  return seconds;
}

double
timePcl(const Cloud::Ptr& source,
        const Cloud::Ptr& target,
        const pcl::search::KdTree<pcl::PointXYZ>::Ptr& tree,
        const MonteCarloIcpRun& run)
{
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setSearchMethodTarget(tree, true);
  icp.setInputSource(source);
  icp.setInputTarget(target);
  icp.setMaximumIterations(MonteCarloIcpOptions().icp.max_iterations);
  Cloud moved;
  const double begin = io::cpuSeconds();
  icp.align(moved, isometryOf(run.start).matrix().cast<float>());
  return io::cpuSeconds() - begin;
}

void
print(const char* name, const std::vector<double>& seconds)
{
  const Mean mean = meanOf(seconds);
  std::printf("%s: %.1f +- %.1f ms a run (%zu runs)\n",
              name,
              1e3 * mean.value,
              1e3 * mean.standard_error,
              seconds.size());
}

} // namespace

int
main(int argc, char** argv)
{
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s FOLDER [RUNS [PCL_RUNS]]\n", argv[0]);
    return 2;
  }
  const std::string folder = argv[1];
  const int num_runs = argc > 2 ? std::atoi(argv[2]) : 100;
  const int num_pcl_runs = std::min(num_runs, argc > 3 ? std::atoi(argv[3]) : 5);
  if (num_pcl_runs < 2) {
    std::fprintf(stderr, "%s: a mean needs two runs or more\n", argv[0]);
    return 2;
  }
  const Cloud::Ptr source = readCloud(folder + "/source.pcd");
  const Cloud::Ptr target = readCloud(folder + "/target.pcd");
  std::vector<MonteCarloIcpRun> runs;
  const std::vector<double> ours = timeOurs(
      pointsOf(*source).cast<double>(), KdTree(pointsOf(*target)), num_runs, runs);
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(
      new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(target);
  std::vector<double> theirs, same_starts;
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_pcl_runs); ++i) {
    theirs.push_back(timePcl(source, target, tree, runs[i]));
    same_starts.push_back(ours[i]);
  }
  print("ours", ours);
  print("ours, the starts that PCL had", same_starts);
  print("pcl::IterativeClosestPoint", theirs);
  std::printf("ratio %.1f\n", meanOf(theirs).value / meanOf(same_starts).value);
  const Mean mean = meanOf(ours);
  std::printf("10000 runs on two cores: %.0f +- %.0f s if both are free and as fast\n",
              mean.value * num_paper_runs / 2.0,
              mean.standard_error * num_paper_runs / 2.0);
  return 0;
}
