#include "csv_fields.h"
#include "draw_statistics.h"
#include "input_hash.h"
#include "paper/paper_experiment.h"
#include "paper/paper_methods.h"
#include "paper/paper_table.h"
#include "run_file.h"

#include <io/text_hash.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <tuple>

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

    bool
    operator<(const Name& other) const
    {
      return std::tie(key, pair, method, num_threads, seed) <
             std::tie(
                 other.key, other.pair, other.method, other.num_threads, other.seed);
    }
  };

  Name name;
  double wall_seconds = 0.0;
  /** Of all threads. */
  double cpu_seconds = 0.0;
  std::string status;

  static std::string
  header()
  {
    return "key,pair,method,threads,seed,wall_s_per_1000_draws,"
           "cpu_s_per_1000_draws,status";
  }

  std::string
  row() const
  {
    CsvRow row;
    row.add(name.key).add(name.pair).add(name.method).add(name.num_threads);
    row.add(name.seed).add(wall_seconds).add(cpu_seconds).add(status);
    return row.text();
  }

  static RuntimeRun
  ofRow(const std::string& line)
  {
    CsvFields fields(line);
    RuntimeRun run;
    run.name.key = fields.text();
    run.name.pair = fields.text();
    run.name.method = fields.text();
    fields.read(run.name.num_threads);
    fields.read(run.name.seed);
    fields.read(run.wall_seconds);
    fields.read(run.cpu_seconds);
    run.status = fields.text();
    fields.end();
    return run;
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

/** A pair's seconds by one method and number of threads: the median of its runs, which
 * other work of the machine disturbs least. */
struct PairTime {
  double wall_seconds;
  double cpu_seconds;
};

/** Time what is missing of a pair. */
PairTime
pairTime(const PaperStudy& study,
         const PaperProblem& problem,
         const std::string& method,
         int num_threads,
         RuntimeFile& file)
{
  std::vector<double> wall, cpu;
  for (int i = 0; i < study.options.num_repeats; ++i) {
    const RuntimeRun::Name name{io::textOfHash(problem.pair.key()),
                                problem.pair.name,
                                method,
                                num_threads,
                                study.options.seed + static_cast<std::uint64_t>(i)};
    if (file.find(name) == nullptr)
      file.add(timeRun(problem, name));
    wall.push_back(file.find(name)->wall_seconds);
    cpu.push_back(file.find(name)->cpu_seconds);
  }
  return {median(wall), median(cpu)};
}

/** Over the pairs, of one method, one for each number of threads. */
struct MethodTimes {
  std::string title;
  std::vector<Spread> wall, cpu;
};

/** What the paper states, on an i7-7700 with four cores. */
const std::vector<std::string> stated_seconds = {
    "8.880 ± 3.590", "6.392 ± 0.731", "3.298 ± 0.573"};

using Problems = std::vector<PaperProblem>;

MethodTimes
methodTimes(const PaperStudy& study,
            const Problems& problems,
            const std::string& name,
            RuntimeFile& file)
{
  MethodTimes times{paperMethod(name).title, {}, {}};
  for (const int num_threads : thread_counts) {
    std::vector<double> wall, cpu;
    for (const PaperProblem& problem : problems) {
      const PairTime time = pairTime(study, problem, name, num_threads, file);
      wall.push_back(time.wall_seconds);
      cpu.push_back(time.cpu_seconds);
    }
    times.wall.push_back(spreadOf(wall));
    times.cpu.push_back(spreadOf(cpu));
    study.report("runtime: " + times.title + ", " + std::to_string(num_threads) +
                 " threads, " + textOf(times.wall.back()) + " s per 1000 draws");
  }
  return times;
}

ReportTable
tableOf(const std::vector<MethodTimes>& methods)
{
  ReportTable table;
  table.caption = "Seconds of wall time per 1000 draws, warm-up and estimate included: "
                  "mean ± standard deviation over the pairs, of the median of each "
                  "pair's runs; and seconds of processor time of all threads.";
  table.header = {"method"};
  for (const int num_threads : thread_counts)
    table.header.push_back(std::to_string(num_threads) +
                           (num_threads == 1 ? " thread [s]" : " threads [s]"));
  for (const int num_threads : thread_counts)
    table.header.push_back("processor, " + std::to_string(num_threads) + " [s]");
  for (const MethodTimes& method : methods) {
    std::vector<std::string> row = {method.title};
    for (const auto* spreads : {&method.wall, &method.cpu})
      for (const Spread& spread : *spreads)
        row.push_back(textOf(spread));
    table.rows.push_back(std::move(row));
  }
  std::vector<std::string> paper = {"the paper, Intel i7-7700 with 4 cores"};
  paper.insert(paper.end(), stated_seconds.begin(), stated_seconds.end());
  paper.resize(table.header.size(), "–");
  table.rows.push_back(std::move(paper));
  return table;
}

void
plotTimes(const std::vector<MethodTimes>& methods, const std::string& folder)
{
  std::string blocks, plot;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    std::string lines;
    for (std::size_t k = 0; k < thread_counts.size(); ++k)
      lines += std::to_string(thread_counts[k]) + ' ' +
               io::textOf(methods[i].wall[k].mean) + ' ' +
               io::textOf(methods[i].wall[k].sd) + '\n';
    const std::string name = "runtime" + std::to_string(i);
    blocks += plot::dataBlock(name, lines);
    plot += (i > 0 ? ", $" : "plot $") + name +
            " with yerrorlines linewidth 1.5 pointtype 7 title " +
            plot::quotedForGnuplot(methods[i].title);
  }
  blocks += plot::dataBlock("paper", "1 8.88 3.59\n2 6.392 0.731\n4 3.298 0.573\n");
  plot += ", $paper with yerrorlines dashtype 2 pointtype 6 title 'the paper'\n";
  plot::savePictures(
      "set encoding utf8\n" + blocks +
          "set logscale y\nset grid y\nset xrange [0.5:4.5]\nset xtics (1, 2, 4)\n"
          "set xlabel 'threads'\nset ylabel 'wall time per 1000 draws [s]'\n"
          "set key outside right\n" +
          plot::pictures("800, 450", plot),
      {"runtime"},
      folder);
}

} // namespace

ReportSection
runtimeExperiment(const PaperStudy& study)
{
  RuntimeFile file(study.path("runtime.csv"));
  Problems problems;
  problems.reserve(study.pairs.size());
  for (const ScanPair& pair : study.pairs)
    problems.emplace_back(pair);
  std::vector<MethodTimes> methods;
  methods.reserve(method_names.size());
  for (const std::string& name : method_names)
    methods.push_back(methodTimes(study, problems, name, file));
  plotTimes(methods, study.options.output_folder);
  ReportSection section;
  section.title = "Run time";
  section.blocks.emplace_back(ReportText{
      "Time for 1000 draws by four chains, the tree of the target given. This machine "
      "has " +
      std::to_string(std::thread::hardware_concurrency()) +
      " cores: more threads than that cannot be faster, and other work makes wall time "
      "longer, but hardly processor time. The paper's program is another one on "
      "another machine; its figures are for scale."});
  section.blocks.emplace_back(tableOf(methods));
  section.blocks.emplace_back(ReportFigure{
      "runtime", "Wall time per 1000 draws: mean and standard deviation over pairs."});
  return section;
}

} // namespace bayesian_icp::evaluate
