#include "commands.h"
#include "io/coordinates.h"
#include "io/folders.h"
#include "sbc/rank_study.h"
#include "study/formatted_text.h"
#include "study/option_values.h"
#include "study/report_program.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

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
      throw io::UsageError("--sampler: there is no " + io::inQuotes(name));
    chosen.push_back(*found);
  }
  return chosen;
}

/** What the command line says besides what is run. */
struct SbcOptions {
  /** Names as given; empty: all there are. */
  std::vector<std::string> samplers;
  std::string result_file = "results/sbc.csv";
  bool has_report = false;
};

void
takeSamplers(const std::string& text, SbcOptions& options)
{
  for (const std::string& name : split(text, ','))
    if (name == "exact")
      options.samplers.insert(options.samplers.end(),
                              {"exact-langevin", "exact-metropolis"});
    else
      options.samplers.push_back(name);
}

po::options_description
describeOptions(SbcOptions& options, RankStudy& study)
{
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("sampler", taken("", [&options](const std::string& text) {
       takeSamplers(text, options);
     }),
     "exact-langevin, exact-metropolis, calibrated, calibrated-scans, or several of "
     "them, separated by commas; exact means the first two. The default is all")
    ("runs", integer(study.num_runs, 1, 1000000), "number of runs of each sampler")
    ("seed", integer(study.first_seed, 0, max_seed), "seed of the first run")
    ("output", outputName("file", options.result_file),
     "CSV file of the results, one row for each run. Runs that it already has are "
     "skipped")
    ("report", io::flag(options.has_report),
     "also make a report, with figures, of all results in that folder")
    ("threads", threads(study.num_threads),
     "number of runs at the same time; 0 means as many as there are cores")
    ("help", "show this text");
  // clang-format on
  return description;
}

std::string
sbcHelp(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_evaluate sbc [options]

Simulation-based calibration: are the draws of a sampler draws of the
posterior? True poses are drawn from the prior and data from the very
likelihood; the rank of the true pose among 99 draws is then uniform, in
each of the six coordinates. calibrated-scans ranks true poses of simulated
scans, of which the likelihood is no exact model. Every run is a row of a
CSV file. A table goes to the standard output, progress to the standard
error. Results of another build have to be deleted by hand.
Exit codes: 0 good, 1 ranks are not uniform or draws are no good, 2 usage,
3 cannot read or write a file, or make the report.

)" << options;
  return help.str();
}

std::string
verdictOf(const RankSampler& sampler, bool is_uniform)
{
  if (!sampler.is_well_specified)
    return "no model of the scans: for information";
  return is_uniform ? "uniform" : "NOT UNIFORM";
}

/** A line for each sampler: runs, chi-square statistic of each coordinate,
 * verdict.
 * \return whether every well-specified sampler has uniform ranks: all runs good and
 *         every statistic below max_rank_chi_square */
bool
printRankTable(const RankStudy& study, const RankFile& results, std::ostream& stream)
{
  stream << "                        valid  chi-square of 10 bins, uniform if below "
         << max_rank_chi_square << " (0.1 %)\n  sampler               /runs";
  for (const char* name : app::coordinate_names)
    stream << format("%8s", name);
  stream << '\n';
  bool are_all_uniform = true;
  for (const RankSampler& sampler : study.samplers) {
    const std::vector<Ranks> runs = ranksOfSampler(study, sampler, results);
    stream << format(
        "  %-17s %5zu/%-5d", sampler.name.c_str(), runs.size(), study.num_runs);
    bool is_uniform = runs.size() == static_cast<std::size_t>(study.num_runs);
    for (int k = 0; k < 6; ++k) {
      const double statistic =
          runs.empty() ? std::nan("") : chiSquareOf(rankHistogram(runs, k));
      is_uniform = is_uniform && statistic < max_rank_chi_square;
      stream << format("%8.1f", statistic);
    }
    stream << "  " << verdictOf(sampler, is_uniform) << '\n';
    are_all_uniform = are_all_uniform && (is_uniform || !sampler.is_well_specified);
  }
  return are_all_uniform;
}

} // namespace

int
runSbcCommand(int argc, const char* const* argv)
{
  SbcOptions options;
  RankStudy study;
  const po::options_description description = describeOptions(options, study);
  const po::variables_map given =
      io::splitCommandLine(argc, argv, description, nullptr);
  if (io::printHelpOrVersion(
          given, "", [&description] { return sbcHelp(description); }))
    return 0;
  io::takeOptions(given, description);
  study.samplers = chosenSamplers(options.samplers);
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
