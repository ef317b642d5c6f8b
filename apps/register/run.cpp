#include "register/run.h"

#include <algorithm>
#include <chrono>

namespace bayesian_icp::app {

Run
readRun(const std::string& source_file,
        const std::string& target_file,
        const Settings& settings)
{
  using Clock = std::chrono::steady_clock;
  Run run;
  const auto start = Clock::now();
  run.source = io::readCloud(source_file);
  run.target = io::readCloud(target_file);
  run.reading_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  run.settings = settings;
  run.settings.options.prior.frame =
      priorFrameOf(settings.options, run.source.points.cast<double>());
  run.settings.scaleToClouds(
      run.source.num_finite,
      std::max(run.source.largest_coordinate, run.target.largest_coordinate));
  return run;
}

void
registerClouds(const ProgressCallback& progress,
               Run& run,
               const IcpCallback& icp_progress)
{
  run.result = registerClouds(
      run.source.points, run.target.points, run.settings, progress, icp_progress);
}

} // namespace bayesian_icp::app
