#include "sbc/sbc_command.h"

#include "io/errors.h"
#include "io/folders.h"
#include "sbc/rank_study.h"
#include "sbc/rank_table.h"
#include "sbc/sbc_options.h"
#include "study/report_program.h"

#include <algorithm>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

/** The samplers asked for, all if none are.
 * \throws io::UsageError of one that is not known */
std::vector<RankSampler>
chosenSamplers(const std::vector<std::string>& names)
{
  if (names.empty())
    return rankSamplers();
  std::vector<RankSampler> chosen;
  for (const std::string& name : names) {
    const auto& all = rankSamplers();
    const auto found =
        std::find_if(all.begin(), all.end(), [&name](const RankSampler& sampler) {
          return sampler.name == name;
        });
    if (found == all.end())
      throw io::UsageError("--sampler: there is no " + io::quoted(name));
    chosen.push_back(*found);
  }
  return chosen;
}

} // namespace

int
runSbcCommand(int argc, const char* const* argv)
{
  const SbcOptions options = parseSbcOptions(argc, argv);
  if (options.show_help) {
    std::cout << sbcHelp();
    return 0;
  }
  RankStudy study;
  study.samplers = chosenSamplers(options.samplers);
  study.num_runs = options.num_runs;
  study.first_seed = options.first_seed;
  study.num_threads = options.num_threads;
  study.report = [](std::size_t num_done, std::size_t num_all) {
    if (num_done % 50 == 0 || num_done == num_all)
      std::cerr << num_done << " of " << num_all << " runs" << std::endl;
  };
  RankFile results(options.result_file);
  runRankStudy(study, results);
  const bool are_uniform = printRankTable(study, results, std::cout);
  const int report_code =
      options.has_report ? makeReport(io::folderOf(options.result_file)) : 0;
  return are_uniform ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
