#include "sbc/rank_study.h"

#include "option_values.h"

#include <io/numbers.h>

#include <atomic>
#include <exception>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

constexpr char header[] =
    "sampler,seed,valid,rank_x,rank_y,rank_z,rank_roll,rank_pitch,rank_yaw";
constexpr std::size_t num_columns = 9;

template <typename Number>
Number
numberOf(const std::string& text)
{
  Number number{};
  if (!io::readNumber(text, number))
    throw std::runtime_error("not a number");
  return number;
}

/** One run of one sampler. */
struct Task {
  const RankSampler* sampler;
  std::uint64_t seed;
};

/** In the order of the samplers. */
std::vector<Task>
missingRuns(const RankStudy& study, const RankFile& results)
{
  std::vector<Task> tasks;
  for (const RankSampler& sampler : study.samplers)
    for (int i = 0; i < study.num_runs; ++i) {
      const std::uint64_t seed = study.first_seed + static_cast<std::uint64_t>(i);
      if (!results.has(sampler.name, seed))
        tasks.push_back({&sampler, seed});
    }
  return tasks;
}

} // namespace

RankFile::RankFile(const std::string& name)
: file_(name, header, [this](const std::string& row) {
  const std::vector<std::string> fields = split(row, ',');
  if (fields.size() != num_columns)
    throw std::runtime_error("wrong number of columns");
  std::optional<Ranks> ranks;
  if (numberOf<int>(fields[2]) == 1) {
    ranks.emplace();
    for (std::size_t k = 0; k < 6; ++k) {
      (*ranks)[k] = numberOf<int>(fields[3 + k]);
      if ((*ranks)[k] < 0 || (*ranks)[k] > num_ranked_draws)
        throw std::runtime_error("not a rank");
    }
  }
  runs_[{fields[0], numberOf<std::uint64_t>(fields[1])}] = ranks;
})
{}

bool
RankFile::has(const std::string& sampler, std::uint64_t seed) const
{
  return runs_.count({sampler, seed}) > 0;
}

std::optional<Ranks>
RankFile::find(const std::string& sampler, std::uint64_t seed) const
{
  const auto found = runs_.find({sampler, seed});
  return found == runs_.end() ? std::nullopt : found->second;
}

void
RankFile::add(const std::string& sampler,
              std::uint64_t seed,
              const std::optional<Ranks>& ranks)
{
  std::string row = sampler + ',' + io::textOf(seed) + (ranks ? ",1" : ",0");
  for (int k = 0; k < 6; ++k)
    row += ',' + io::textOf(ranks ? (*ranks)[k] : 0);
  file_.add(row);
  runs_[{sampler, seed}] = ranks;
}

void
runRankStudy(const RankStudy& study, RankFile& results)
{
  const std::vector<Task> tasks = missingRuns(study, results);
  std::size_t num_done = 0;
  std::exception_ptr error;
  std::atomic<bool> has_failed = false;
  // No exception may leave a parallel region or a critical section.
  const auto guarded = [&](const auto& function) {
    try {
      function();
    }
    catch (...) {
      if (!has_failed.exchange(true))
        error = std::current_exception();
    }
  };
#pragma omp parallel for schedule(dynamic) num_threads(study.num_threads)
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const Task& task = tasks[i];
    std::optional<Ranks> ranks;
    if (!has_failed)
      guarded([&] { ranks = task.sampler->run(task.seed); });
#pragma omp critical(rank_results)
    guarded([&] {
      if (has_failed)
        return;
      results.add(task.sampler->name, task.seed, ranks);
      if (study.report)
        study.report(++num_done, tasks.size());
    });
  }
  if (error)
    std::rethrow_exception(error);
}

std::vector<Ranks>
ranksOfSampler(const RankStudy& study,
               const RankSampler& sampler,
               const RankFile& results)
{
  std::vector<Ranks> runs;
  for (int i = 0; i < study.num_runs; ++i)
    if (const auto ranks = results.find(
            sampler.name, study.first_seed + static_cast<std::uint64_t>(i)))
      runs.push_back(*ranks);
  return runs;
}

} // namespace bayesian_icp::evaluate
