#include "io/text_hash.h"
#include "study/text_table.h"
#include "paper/paper_methods.h"
#include "paper/paper_runs.h"
#include "paper/study_record.h"

#include <chrono>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_draws = 1000;
const std::vector<int> thread_counts = {1, 2, 4};
const std::vector<std::string> method_names = {"bayesian-icp", "exact", "calibrated"};

RuntimeRun
timeRun(const PaperProblem& problem, const PaperRunName& name)
{
  DrawPlan plan;
  plan.num_draws = num_draws;
  plan.seed = name.seed;
  plan.num_threads = name.number;
  const auto begin = std::chrono::steady_clock::now();
  const SamplerRun made = paperMethod(name.method).run(problem, plan);
  const std::chrono::duration<double> duration =
      std::chrono::steady_clock::now() - begin;
  return {name, duration.count(), made.seconds, made.status};
}

using Problems = std::vector<PaperProblem>;

/** Time what is missing of one method and number of threads. */
void
timeMethod(const PaperStudy& study,
           const Problems& problems,
           const std::string& method,
           int num_threads,
           RunFile<RuntimeRun>& file,
           MedianTable& table)
{
  const std::string group = method + ", " + std::to_string(num_threads) + " threads";
  for (const PaperProblem& problem : problems)
    for (const std::uint64_t seed : study.options.seeds()) {
      const PaperRunName name{io::textOfHash(problem.pair.key()),
                              problem.pair.name,
                              method,
                              seed,
                              num_threads};
      const RuntimeRun& run =
          file.findOrMake(name, [&] { return timeRun(problem, name); });
      table.add(group, {run.wall_seconds, run.cpu_seconds});
    }
  study.report("runtime: " + group);
}

} // namespace

void
runtimeExperiment(const PaperStudy& study)
{
  RunFile<RuntimeRun> file(study.path("runtime.csv"));
  Problems problems;
  std::vector<PairKey> keys;
  problems.reserve(study.pairs.size());
  for (const ScanPair& pair : study.pairs) {
    problems.emplace_back(pair);
    keys.push_back({pair.name, io::textOfHash(pair.key())});
  }
  MedianTable table("runtime: seconds per 1000 draws", {"wall [s]", "CPU [s]"});
  for (const std::string& name : method_names)
    for (const int num_threads : thread_counts)
      timeMethod(study, problems, name, num_threads, file, table);
  recordExperiment(study, "runtime", keys);
  table.print(std::cout);
}

} // namespace bayesian_icp::evaluate
