#include "paper/monte_carlo_runs.h"

#include "io/numbers.h"
#include "io/text_hash.h"
#include "study/csv_fields.h"
#include "study/input_hash.h"
#include "study/row_file.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

/** To be changed with what a run does: old files are then ignored. */
constexpr char version[] = "monte carlo icp 1";

constexpr char header[] =
    "index,start_x_m,start_y_m,start_z_m,start_roll_rad,start_pitch_rad,start_yaw_rad,"
    "x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad,stop,iterations,mean_squared_distance_m2";

constexpr int block_size = 100;
constexpr double seconds_between_reports = 5.0;

using Clock = std::chrono::steady_clock;
using Report = std::function<void(const std::string&)>;

/** Numbers of a run in the order of the columns around `stop`. */
template <typename Run, typename Visit>
void
forEachNumber(Run& run, const Visit& visit)
{
  visit(run.index);
  for (auto* pose : {&run.start, &run.end})
    for (int k = 0; k < 6; ++k)
      visit((*pose)[k]);
}

std::string
rowOf(const MonteCarloIcpRun& run)
{
  CsvRow row;
  forEachNumber(run, [&row](auto number) { row.add(number); });
  row.add(std::string(toString(run.stop)));
  return row.add(run.num_iterations).add(run.mean_squared_distance).text();
}

IcpStop
stopOf(std::string_view name)
{
  for (const IcpStop stop : {IcpStop::TooFewPairs,
                             IcpStop::MaxIterations,
                             IcpStop::Transformation,
                             IcpStop::AbsoluteFitness,
                             IcpStop::RelativeFitness})
    if (name == toString(stop))
      return stop;
  throw std::runtime_error("not an end of ICP");
}

/** \throws std::exception if the line is not a row */
MonteCarloIcpRun
runOf(const std::string& line)
{
  CsvFields fields(line);
  MonteCarloIcpRun run;
  forEachNumber(run, [&fields](auto& number) { fields.read(number); });
  run.stop = stopOf(fields.text());
  run.has_converged = run.stop != IcpStop::TooFewPairs;
  fields.read(run.num_iterations);
  fields.read(run.mean_squared_distance);
  fields.end();
  return run;
}

using RunMap = std::map<int, MonteCarloIcpRun>;

/** The next runs that are not there, without a gap; num_runs 0: there are none. */
MonteCarloIcpOptions
nextBlock(const MonteCarloIcpOptions& options, const RunMap& runs)
{
  MonteCarloIcpOptions block = options;
  const int end = options.first_run + options.num_runs;
  while (block.first_run < end && runs.count(block.first_run) > 0)
    ++block.first_run;
  block.num_runs = 0;
  while (block.num_runs < block_size && block.first_run + block.num_runs < end &&
         runs.count(block.first_run + block.num_runs) == 0)
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
  RunMap runs;
  const RowFile rows(file.name(monteCarloKey(source, target, options)),
                     header,
                     [&runs](const std::string& row) {
                       const MonteCarloIcpRun run = runOf(row);
                       runs[run.index] = run;
                     });
  const auto isAsked = [&options](int index) {
    return index >= options.first_run && index < options.first_run + options.num_runs;
  };
  const auto num_known = std::count_if(
      runs.begin(), runs.end(), [&](const auto& run) { return isAsked(run.first); });
  Progress progress(options.num_runs - static_cast<int>(num_known), report);
  int num_done = 0;
  for (auto block = nextBlock(options, runs); block.num_runs > 0;
       block = nextBlock(options, runs)) {
    const auto made = monteCarloIcp(source, target, block, [&](int done) {
      progress.show(num_done + done);
      return true;
    });
    for (const MonteCarloIcpRun& run : made) {
      rows.add(rowOf(run));
      runs[run.index] = run;
    }
    num_done += block.num_runs;
  }
  std::vector<MonteCarloIcpRun> asked;
  for (const auto& run : runs)
    if (isAsked(run.first))
      asked.push_back(run.second);
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
