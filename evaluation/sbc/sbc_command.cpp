#include "commands.h"
#include "sbc/ranks.h"
#include "study/named.h"
#include "study/option_values.h"
#include "study/parallel_tasks.h"
#include "study/text_table.h"

#include <iostream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

/** What is run, and where it is kept. */
struct SbcOptions {
  std::vector<RankSampler> samplers = rankSamplers();
  int num_runs = 500;
  std::uint64_t first_seed = 1;
  int num_threads = 1;
  ResultOptions result = {"results/sbc.csv"};
};

constexpr char sbc_help[] = R"(Usage: pcl_bayesian_icp_evaluate sbc [options]

Simulation-based calibration: does a sampler draw from the posterior? True
poses are drawn from the prior, and data from the likelihood that the sampler
assumes. The rank of the true pose among 99 draws is then uniform in each of
the six coordinates. calibrated-scans ranks the true poses of simulated scans,
which the likelihood models only approximately. Each run is a row of a CSV
file. The table goes to standard output, progress to standard error. Delete
results of another build by hand.
Exit codes: 0 success, 1 ranks are not uniform or draws are unusable, 2 usage,
3 a file cannot be read or written, or the report cannot be made.
)";

/** The samplers of these names, all of them if there are none.
 * \throws io::BadValue of a name that is not known */
std::vector<RankSampler>
samplersOf(const std::string& text)
{
  std::vector<RankSampler> chosen;
  for (const std::string& name : wordsOf(text)) {
    bool is_known = false;
    for (const RankSampler& sampler : rankSamplers()) {
      if (sampler.name != name &&
          !(name == "exact" && sampler.name.rfind("exact-", 0) == 0))
        continue;
      is_known = true;
      if (findNamed(chosen, sampler.name) == nullptr)
        chosen.push_back(sampler);
    }
    if (!is_known)
      requireKnown({name}, namesOf(rankSamplers()));
  }
  return chosen.empty() ? rankSamplers() : chosen;
}

po::options_description
describeOptions(SbcOptions& options)
{
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("sampler", taken("", [&options](const std::string& text) {
       options.samplers = samplersOf(text);
     }),
     "exact-langevin, exact-metropolis, calibrated, calibrated-scans, or several of "
     "them, separated by commas; exact means the first two. The default is all")
    ("runs", integer(options.num_runs, 1, 1000000), "number of runs of each sampler")
    ("seed", integer(options.first_seed, 0, max_seed), "seed of the first run")
    ("threads", threads(options.num_threads),
     "number of runs at the same time; 0 means as many as there are cores");
  // clang-format on
  addResultOptions(options.result, description);
  return description;
}

/** The names of all runs of a sampler. */
std::vector<RankRun::Name>
runNamesOf(const RankSampler& sampler, const SbcOptions& options)
{
  std::vector<RankRun::Name> names;
  for (int i = 0; i < options.num_runs; ++i)
    names.push_back({sampler.name, options.first_seed + static_cast<std::uint64_t>(i)});
  return names;
}

/** Run what \p results does not have. A row does not depend on the number of threads.
 */
void
runMissing(const SbcOptions& options, RankFile& results)
{
  struct Task {
    const RankSampler& sampler;
    RankRun::Name name;
  };
  std::vector<Task> missing;
  for (const RankSampler& sampler : options.samplers)
    for (const RankRun::Name& name : runNamesOf(sampler, options))
      if (results.find(name) == nullptr)
        missing.push_back({sampler, name});
  const auto run = [&](std::size_t i) {
    const std::optional<Ranks> ranks = missing[i].sampler.run(missing[i].name.seed);
    results.add({missing[i].name, ranks.has_value(), ranks.value_or(Ranks::Zero())});
  };
  runTasks(missing.size(), options.num_threads, "runs", run);
}

} // namespace

int
runSbcCommand(int argc, const char* const* argv)
{
  SbcOptions options;
  readOptions(argc, argv, describeOptions(options), sbc_help);
  RankFile results(options.result.file);
  runMissing(options, results);
  std::vector<RankRun> runs;
  for (const RankSampler& sampler : options.samplers)
    for (const RankRun::Name& name : runNamesOf(sampler, options))
      runs.push_back(*results.find(name));
  const RankVerdict verdict = verdictOf(runs);
  std::cout << format("Chi-square of %d bins, uniform if below %g (0.1 %%)\n",
                      num_rank_bins,
                      max_rank_chi_square)
            << textOfTable(verdict.rows);
  const int report_code = options.result.report();
  return verdict.are_uniform ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
