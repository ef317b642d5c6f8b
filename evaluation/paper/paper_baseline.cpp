#include "paper/paper_baseline.h"

#include "io/clocks.h"
#include "io/errors.h"
#include "io/text_hash.h"
#include "study/input_hash.h"
#include "study/parallel_tasks.h"
#include "study/run_file.h"

#include <bayesian_icp/summary.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

/** To be changed with what a run does: old files are then ignored. */
constexpr char version[] = "monte carlo icp 2";

constexpr int block_size = 100;

IcpStop
stopOf(std::string_view name)
{
  for (const IcpStop stop : icp_stops)
    if (name == toString(stop))
      return stop;
  throw std::runtime_error("not an end of ICP");
}

/** A row of the file. */
struct KeptRun {
  static constexpr int num_name_columns = 1;

  struct Name {
    int index = 0;
  };

  Name name;
  MonteCarloIcpRun run;

  template <typename Column>
  void
  columns(const Column& column)
  {
    std::string stop = toString(run.stop);
    column("index", name.index);
    unitColumns("start_", run.start, column);
    unitColumns("", run.end, column);
    column("stop", stop);
    column("iterations", run.num_iterations);
    column("mean_squared_distance_m2", run.mean_squared_distance);
    run.index = name.index;
    run.stop = stopOf(stop);
    run.has_converged = run.stop != IcpStop::TooFewPairs;
  }
};

using KeptRuns = RunFile<KeptRun>;

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

} // namespace

std::uint64_t
monteCarloKey(const Eigen::Matrix3Xd& source,
              const Eigen::Matrix3Xd& target,
              const MonteCarloIcpOptions& options)
{
  InputHash hash;
  hash.add(version, sizeof version);
  hash.addMatrix(source);
  hash.addMatrix(target);
  hash.addMatrix(options.mean);
  hash.addMatrix(options.half_range);
  hash.add(&options.seed, sizeof options.seed);
  hash.add(static_cast<double>(options.max_iterations));
  hash.add(options.max_distance);
  return hash.value();
}

std::string
monteCarloFile(const std::string& folder, const std::string& pair, std::uint64_t key)
{
  return folder + "/monte_carlo_" + pair + '_' + io::textOfHash(key) + ".csv";
}

std::vector<MonteCarloIcpRun>
keptMonteCarloRuns(const Eigen::Matrix3Xd& source,
                   const Eigen::Matrix3Xd& target,
                   const MonteCarloIcpOptions& options,
                   const std::string& file,
                   const std::function<void(const std::string&)>& report)
{
  KeptRuns runs(file);
  const int end = options.first_run + options.num_runs;
  const double begin = io::wallSeconds();
  int num_made = 0;
  std::vector<MonteCarloIcpRun> asked;
  for (int index = options.first_run; index < end; ++index) {
    if (runs.find({index}) == nullptr) {
      MonteCarloIcpOptions block = options;
      block.first_run = index;
      block.num_runs = std::min(block_size, end - index);
      for (const MonteCarloIcpRun& run : monteCarloIcp(source, target, block))
        runs.findOrMake({run.index}, [&run] { return KeptRun{{run.index}, run}; });
      num_made += block.num_runs;
      report(progressText(static_cast<std::size_t>(index + block.num_runs),
                          static_cast<std::size_t>(end),
                          "runs of ICP",
                          (io::wallSeconds() - begin) / num_made));
    }
    asked.push_back(runs.find({index})->run);
  }
  return asked;
}

PoseMatrix
endsOf(const std::vector<MonteCarloIcpRun>& runs)
{
  PoseMatrix ends(static_cast<Eigen::Index>(runs.size()), 6);
  Eigen::Index row = 0;
  for (const MonteCarloIcpRun& run : runs)
    if (run.has_converged)
      ends.row(row++) = run.end.transpose();
  ends.conservativeResize(row, 6);
  return ends;
}

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

ComparedPair::ComparedPair(const PaperStudy& study, const ScanPair& pair)
: problem(pair)
{
  const MonteCarloIcpOptions options = baselineOptions(study.options);
  const std::uint64_t runs_key = monteCarloKey(pair.source, pair.target, options);
  baseline = baselineOf(
      pair.name,
      keptMonteCarloRuns(
          pair.source,
          pair.target,
          options,
          monteCarloFile(study.options.output_folder, pair.name, runs_key),
          [&](const std::string& line) { study.report(pair.name + ": " + line); }));
  const std::uint64_t numbers[] = {
      pair.key(), runs_key, static_cast<std::uint64_t>(options.num_runs)};
  InputHash hash;
  hash.add(numbers, sizeof numbers);
  key = io::textOfHash(hash.value());
}

} // namespace bayesian_icp::evaluate
