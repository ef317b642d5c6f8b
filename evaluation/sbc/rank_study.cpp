#include "sbc/rank_study.h"

#include "threads/first_exception.h"

namespace bayesian_icp::evaluate {

namespace {

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
      if (results.find({sampler.name, seed}) == nullptr)
        tasks.push_back({&sampler, seed});
    }
  return tasks;
}

} // namespace

void
runRankStudy(const RankStudy& study, RankFile& results)
{
  const std::vector<Task> tasks = missingRuns(study, results);
  std::size_t num_done = 0;
  // No exception may leave a parallel region or a critical section.
  FirstException failure;
#pragma omp parallel for schedule(dynamic) num_threads(study.num_threads)
  for (std::size_t i = 0; i < tasks.size(); ++i)
    failure.guard([&] {
      const Task& task = tasks[i];
      const std::optional<Ranks> ranks = task.sampler->run(task.seed);
#pragma omp critical(rank_results)
      failure.guard([&] {
        results.add({{task.sampler->name, task.seed},
                     ranks.has_value(),
                     ranks.value_or(Ranks::Zero())});
        if (study.report)
          study.report(++num_done, tasks.size());
      });
    });
  failure.rethrow();
}

std::vector<Ranks>
ranksOfSampler(const RankStudy& study,
               const RankSampler& sampler,
               const RankFile& results)
{
  std::vector<Ranks> runs;
  for (int i = 0; i < study.num_runs; ++i)
    if (const RankRun* run = results.find(
            {sampler.name, study.first_seed + static_cast<std::uint64_t>(i)});
        run != nullptr && run->is_valid)
      runs.push_back(run->ranks);
  return runs;
}

} // namespace bayesian_icp::evaluate
