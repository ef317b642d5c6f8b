#include "paper/paper_baseline.h"

#include "io/errors.h"
#include "io/text_hash.h"
#include "paper/monte_carlo_runs.h"
#include "study/input_hash.h"

#include <bayesian_icp/summary.h>

#include <algorithm>
#include <limits>

namespace bayesian_icp::evaluate {

namespace {

constexpr double main_basin_factor = 2.0;

MonteCarloIcpOptions
baselineOptions(const PaperStudyOptions& paper)
{
  MonteCarloIcpOptions options;
  options.half_range << Eigen::Vector3d::Constant(paper.start_translation),
      Eigen::Vector3d::Constant(paper.start_rotation);
  options.num_runs = paper.num_baseline_runs;
  options.seed = paper.seed;
  options.num_threads = paper.num_threads;
  return options;
}

std::vector<MonteCarloIcpRun>
keptRuns(const PaperStudy& study, const PaperProblem& problem)
{
  const std::string& name = problem.pair.name;
  return keptMonteCarloRuns(
      problem.pair.source,
      problem.tree,
      baselineOptions(study.options),
      {study.options.output_folder, name},
      [&](const std::string& line) { study.report(name + ": " + line); });
}

std::string
keyOf(const PaperStudyOptions& options, const PaperProblem& problem)
{
  const MonteCarloIcpOptions baseline = baselineOptions(options);
  const std::uint64_t numbers[] = {
      problem.pair.key(),
      monteCarloKey(problem.pair.source, problem.tree, baseline),
      static_cast<std::uint64_t>(baseline.num_runs)};
  InputHash hash;
  hash.add(numbers, sizeof numbers);
  return io::textOfHash(hash.value());
}

} // namespace

PaperBaseline
baselineOf(const std::string& pair_name, const std::vector<MonteCarloIcpRun>& runs)
{
  PaperBaseline baseline;
  baseline.ends = endsOf(runs);
  if (baseline.ends.rows() < 2)
    throw io::FileError(pair_name, "fewer than two runs of ICP had enough pairs");
  double least = std::numeric_limits<double>::infinity();
  for (const MonteCarloIcpRun& run : runs)
    if (run.has_converged)
      least = std::min(least, run.mean_squared_distance);
  std::vector<MonteCarloIcpRun> main_runs;
  for (const MonteCarloIcpRun& run : runs)
    if (run.mean_squared_distance <= main_basin_factor * least)
      main_runs.push_back(run);
  baseline.main_ends = endsOf(main_runs);
  baseline.mean = coordinateMeans(baseline.ends);
  return baseline;
}

ComparedPair::ComparedPair(const PaperStudy& study, const ScanPair& scan_pair)
: problem(scan_pair)
, baseline(baselineOf(scan_pair.name, keptRuns(study, problem)))
, key(keyOf(study.options, problem))
{}

} // namespace bayesian_icp::evaluate
