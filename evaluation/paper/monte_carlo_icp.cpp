#include "paper/monte_carlo_icp.h"

#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <pcl/registration/icp.h>
#include <pcl/registration/impl/bayesian_icp_search.hpp>
#include <pcl/registration/impl/seeded_kd_tree.hpp>

#include <algorithm>

namespace bayesian_icp::evaluate {

namespace {

using IcpPoint = pcl::PointXYZ;
using IcpCloud = pcl::PointCloud<IcpPoint>;
using IcpTree = pcl::bayesian_icp_detail::SeededKdTree<IcpPoint>;

/** Without the points on which PCL's search tree aborts. */
IcpCloud::Ptr
cloudOf(const Eigen::Matrix3Xd& points)
{
  const IcpCloud::Ptr cloud(new IcpCloud);
  for (const auto& point : points.cast<float>().colwise())
    if (pcl::bayesian_icp_detail::canBeQueried(point))
      cloud->push_back({point.x(), point.y(), point.z()});
  return cloud;
}

/** What all runs share, and none changes. */
struct IcpClouds {
  IcpCloud::Ptr source;
  IcpCloud::Ptr target;
  IcpTree::Ptr tree{new IcpTree};
};

/** PCL's ICP, which finds its pairs by the library's tree: an eighth of the time. */
class MonteCarloIcp : public pcl::IterativeClosestPoint<IcpPoint, IcpPoint, double> {
public:
  MonteCarloIcp(const IcpClouds& clouds, const MonteCarloIcpOptions& options)
  {
    using Estimation =
        pcl::bayesian_icp_detail::SeededEstimation<IcpPoint, IcpPoint, double>;
    const auto estimation = pcl::make_shared<Estimation>();
    estimation->num_threads = 1;
    setCorrespondenceEstimation(estimation);
    setSearchMethodTarget(clouds.tree, true);
    setInputSource(clouds.source);
    setInputTarget(clouds.target);
    setMaximumIterations(options.max_iterations);
    setMaxCorrespondenceDistance(options.max_distance);
  }

  /** Completes a run that has its start. */
  void
  complete(MonteCarloIcpRun& run)
  {
    IcpCloud moved;
    align(moved, matrixOf(run.start));
    run.end = poseOf(getFinalTransformation());
    run.has_converged = hasConverged();
    run.num_iterations = nr_iterations_;
    if (!run.has_converged)
      return;
    run.stop = stop();
    run.mean_squared_distance = 0.0;
    for (const pcl::Correspondence& pair : *correspondences_)
      run.mean_squared_distance += static_cast<double>(pair.distance);
    run.mean_squared_distance /= static_cast<double>(correspondences_->size());
  }

private:
  IcpStop
  stop() const
  {
    using State = pcl::registration::DefaultConvergenceCriteria<double>;
    switch (convergence_criteria_->getConvergenceState()) {
    case State::CONVERGENCE_CRITERIA_ITERATIONS:
      return IcpStop::MaxIterations;
    case State::CONVERGENCE_CRITERIA_TRANSFORM:
      return IcpStop::Transformation;
    default:
      return IcpStop::AbsoluteFitness;
    }
  }
};

Vector6d
drawStart(const MonteCarloIcpOptions& options, int index)
{
  Random random(options.seed, static_cast<std::uint64_t>(index));
  Vector6d start;
  for (int k = 0; k < 6; ++k)
    start[k] = options.mean[k] + options.half_range[k] * (2.0 * random.uniform() - 1.0);
  return start;
}

} // namespace

const char*
toString(IcpStop stop)
{
  switch (stop) {
  case IcpStop::TooFewPairs:
    return "too_few_pairs";
  case IcpStop::MaxIterations:
    return "max_iterations";
  case IcpStop::Transformation:
    return "transformation";
  case IcpStop::AbsoluteFitness:
    return "absolute_fitness";
  }
  return "";
}

std::vector<MonteCarloIcpRun>
monteCarloIcp(const Eigen::Matrix3Xd& source,
              const Eigen::Matrix3Xd& target,
              const MonteCarloIcpOptions& options)
{
  const int max_runs = std::numeric_limits<int>::max() - std::max(0, options.first_run);
  const int num_runs = std::clamp(options.num_runs, 0, max_runs);
  const IcpClouds clouds{cloudOf(source), cloudOf(target)};
  clouds.tree->setInputCloud(clouds.target);
  std::vector<MonteCarloIcpRun> runs(static_cast<std::size_t>(num_runs));
  forEachPiece(num_runs, options.num_threads, [&](int i) {
    MonteCarloIcpRun& run = runs[static_cast<std::size_t>(i)];
    run.index = options.first_run + i;
    run.start = drawStart(options, run.index);
    MonteCarloIcp(clouds, options).complete(run);
  });
  return runs;
}

} // namespace bayesian_icp::evaluate
