#include "paper/monte_carlo_runs.h"

#include "io/numbers.h"
#include "io/text_hash.h"
#include "study/input_hash.h"
#include "study/run_file.h"

#include <chrono>
#include <stdexcept>
#include <type_traits>

namespace bayesian_icp::evaluate {

namespace {

/** To be changed with what a run does: old files are then ignored. */
constexpr char version[] = "monte carlo icp 1";

constexpr int block_size = 100;
constexpr double seconds_between_reports = 5.0;

using Clock = std::chrono::steady_clock;
using Report = std::function<void(const std::string&)>;

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

  template <typename Self, typename Column>
  static void
  columns(Self& self, const Column& column)
  {
    auto& run = self.run;
    std::string stop = toString(run.stop);
    column("index", self.name.index);
    unitColumns("start_", run.start, column);
    unitColumns("", run.end, column);
    column("stop", stop);
    column("iterations", run.num_iterations);
    column("mean_squared_distance_m2", run.mean_squared_distance);
    if constexpr (!std::is_const_v<Self>) {
      run.index = self.name.index;
      run.stop = stopOf(stop);
      run.has_converged = run.stop != IcpStop::TooFewPairs;
    }
  }
};

using KeptRuns = RunFile<KeptRun>;

/** The next runs that are not there, without a gap; num_runs 0: there are none. */
MonteCarloIcpOptions
nextBlock(const MonteCarloIcpOptions& options, const KeptRuns& runs)
{
  MonteCarloIcpOptions block = options;
  const int end = options.first_run + options.num_runs;
  while (block.first_run < end && runs.find({block.first_run}) != nullptr)
    ++block.first_run;
  block.num_runs = 0;
  while (block.num_runs < block_size && block.first_run + block.num_runs < end &&
         runs.find({block.first_run + block.num_runs}) == nullptr)
    ++block.num_runs;
  return block;
}

/** Lines of progress, not too many of them. */
class Progress {
public:
  Progress(int num_missing, const Report& report)
  : num_missing_(num_missing)
  , report_(report)
  {}

  void
  show(int num_done)
  {
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    const bool is_due = num_done == num_missing_
                            ? last_ > 0.0
                            : seconds >= last_ + seconds_between_reports;
    if (!report_ || num_done == 0 || !is_due)
      return;
    last_ = seconds;
    report_(io::textOf(num_done) + " of " + io::textOf(num_missing_) +
            " runs of ICP, about " +
            io::fixedTextOf(seconds * (num_missing_ - num_done) / num_done, 0) +
            " s left");
  }

private:
  int num_missing_;
  const Report& report_;
  Clock::time_point begin_ = Clock::now();
  double last_ = 0.0;
};

} // namespace

std::uint64_t
monteCarloKey(const Eigen::Matrix3Xd& source,
              const KdTree& target,
              const MonteCarloIcpOptions& options)
{
  InputHash hash;
  hash.add(version, sizeof version);
  hash.addMatrix(source);
  hash.addMatrix(target.points());
  hash.addMatrix(options.mean);
  hash.addMatrix(options.half_range);
  hash.add(&options.seed, sizeof options.seed);
  for (const double number : {static_cast<double>(options.icp.max_iterations),
                              options.icp.max_distance,
                              options.icp.transformation_epsilon,
                              options.icp.euclidean_fitness_epsilon,
                              options.icp.rotation_epsilon,
                              options.icp.absolute_fitness_epsilon})
    hash.add(number);
  return hash.value();
}

std::string
MonteCarloFile::name(std::uint64_t key) const
{
  return folder + "/monte_carlo_" + pair + '_' + io::textOfHash(key) + ".csv";
}

std::vector<MonteCarloIcpRun>
keptMonteCarloRuns(const Eigen::Matrix3Xd& source,
                   const KdTree& target,
                   const MonteCarloIcpOptions& options,
                   const MonteCarloFile& file,
                   const Report& report)
{
  KeptRuns runs(file.name(monteCarloKey(source, target, options)));
  const int end = options.first_run + options.num_runs;
  int num_missing = 0, num_done = 0;
  for (int index = options.first_run; index < end; ++index)
    num_missing += runs.find({index}) == nullptr ? 1 : 0;
  Progress progress(num_missing, report);
  for (auto block = nextBlock(options, runs); block.num_runs > 0;
       block = nextBlock(options, runs)) {
    const auto made = monteCarloIcp(source, target, block, [&](int done) {
      progress.show(num_done + done);
      return true;
    });
    for (const MonteCarloIcpRun& run : made)
      runs.add({{run.index}, run});
    num_done += block.num_runs;
  }
  std::vector<MonteCarloIcpRun> asked;
  for (int index = options.first_run; index < end; ++index)
    asked.push_back(runs.find({index})->run);
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

} // namespace bayesian_icp::evaluate
