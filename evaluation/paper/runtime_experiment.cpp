#include "io/text_hash.h"
#include "paper/median_table.h"
#include "paper/paper_methods.h"
#include "paper/study_record.h"
#include "study/run_file.h"

#include <chrono>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_draws = 1000;
const std::vector<int> thread_counts = {1, 2, 4};
const std::vector<std::string> method_names = {"bayesian-icp", "exact", "calibrated"};

/** One timing. */
struct RuntimeRun {
  struct Name {
    std::string key, pair, method;
    int num_threads = 0;
    std::uint64_t seed = 0;

    template <typename Self, typename Column>
    static void
    columns(Self& self, const Column& column)
    {
      column("key", self.key);
      column("pair", self.pair);
      column("method", self.method);
      column("threads", self.num_threads);
      column("seed", self.seed);
    }
  };

  Name name;
  double wall_seconds = 0.0;
  /** Of all threads. */
  double cpu_seconds = 0.0;
  std::string status;

  template <typename Self, typename Column>
  static void
  columns(Self& self, const Column& column)
  {
    Name::columns(self.name, column);
    column("wall_s_per_1000_draws", self.wall_seconds);
    column("cpu_s_per_1000_draws", self.cpu_seconds);
    column("status", self.status);
  }
};

using RuntimeFile = RunFile<RuntimeRun>;

RuntimeRun
timeRun(const PaperProblem& problem, const RuntimeRun::Name& name)
{
  DrawPlan plan;
  plan.num_draws = num_draws;
  plan.seed = name.seed;
  plan.num_threads = name.num_threads;
  const auto begin = std::chrono::steady_clock::now();
  const PaperRun made = paperMethod(name.method).run(problem, plan);
  const std::chrono::duration<double> duration =
      std::chrono::steady_clock::now() - begin;
  return {name, duration.count(), made.sampled.seconds, made.status};
}

using Problems = std::vector<PaperProblem>;

/** Time what is missing of one method and number of threads. */
void
timeMethod(const PaperStudy& study,
           const Problems& problems,
           const std::string& method,
           int num_threads,
           RuntimeFile& file,
           MedianTable& table)
{
  const std::string group = method + ", " + std::to_string(num_threads) + " threads";
  for (const PaperProblem& problem : problems)
    for (int i = 0; i < study.options.num_repeats; ++i) {
      const RuntimeRun::Name name{io::textOfHash(problem.pair.key()),
                                  problem.pair.name,
                                  method,
                                  num_threads,
                                  study.options.seed + static_cast<std::uint64_t>(i)};
      if (file.find(name) == nullptr)
        file.add(timeRun(problem, name));
      const RuntimeRun& run = *file.find(name);
      table.add(group, {run.wall_seconds, run.cpu_seconds});
    }
  study.report("runtime: " + group);
}

} // namespace

void
runtimeExperiment(const PaperStudy& study)
{
  RuntimeFile file(study.path("runtime.csv"));
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
