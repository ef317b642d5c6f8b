#include "register/sgd_run.h"

#include "io/interrupt.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "register/progress_bar.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/tree_search.h>

#include <chrono>
#include <iostream>
#include <optional>

namespace bayesian_icp::app {

namespace {

using Clock = std::chrono::steady_clock;

double
secondsSince(Clock::time_point start)
{
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double
meanSquaredDistance(const Eigen::Matrix3Xd& source,
                    const KdTree& target,
                    const Vector6d& pose)
{
  Eigen::Matrix3Xd moved;
  movePoints(pose, source, moved);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < moved.cols(); ++i)
    sum += static_cast<double>(
        target
            .nearest(moved.col(i).cast<float>(), std::numeric_limits<float>::infinity())
            .squared_distance);
  return sum / static_cast<double>(moved.cols());
}

SgdRun
registerFiles(const Request& request)
{
  io::silencePcl();
  SgdRun run;
  run.settings = *request.sgd;
  auto start = Clock::now();
  run.source = io::readCloud(request.source_file);
  run.target = io::readCloud(request.target_file);
  run.reading_seconds = secondsSince(start);

  ProgressBar bar(!request.is_quiet, "descending");
  io::catchInterrupt();
  start = Clock::now();
  const Eigen::Matrix3Xd source = io::finitePoints(run.source).cast<double>();
  const KdTree tree(run.target.points);
  const SgdSettings& settings = run.settings;
  run.result = stochasticGradientIcp(
      source,
      TreeSearch(tree, settings.max_distance),
      poseOf(settings.guess),
      settings.options,
      [&](int iteration, const Vector6d&) {
        const long steps = iteration;
        bar.update({0, steps, steps, settings.options.max_iterations});
        return !io::wasInterrupted();
      });
  run.registration_seconds = secondsSince(start);
  run.mean_squared_distance = meanSquaredDistance(source, tree, run.result.pose);
  return run;
}

void
writeFiles(const SgdRun& run, io::OutputFolder& folder)
{
  folder.add("aligned.pcd", [&](std::ostream& stream) {
    writeAligned(run.source, run.target, matrixOf(run.result.pose), stream);
  });
  folder.add("sgd_icp.json", sgdJson(run));
  folder.commit();
}

} // namespace

int
runSgdIcp(const Request& request)
{
  std::optional<io::OutputFolder> folder;
  if (!request.output_folder.empty())
    folder.emplace(request.output_folder);
  const SgdRun run = registerFiles(request);
  const bool has_moved = run.result.num_iterations > 0;
  if (folder && has_moved)
    writeFiles(run, *folder);
  else if (folder)
    std::cerr << "pcl_bayesian_icp: no step was made, so no files are written\n";
  if (!request.is_quiet)
    io::print(request.is_json ? sgdJson(run) : sgdReportText(run));
  // The table has the status already.
  if (!run.result.has_converged && (request.is_json || request.is_quiet))
    std::cerr << "pcl_bayesian_icp: " << endText(run) << '\n';
  if (io::wasInterrupted())
    return io::interrupted_exit_code;
  return run.result.has_converged ? 0 : 1;
}

} // namespace bayesian_icp::app
