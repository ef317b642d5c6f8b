#include "commands.h"
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/folders.h"
#include "io/program.h"
#include "paper/paper_experiment.h"
#include "study/option_values.h"

#include <iostream>
#include <numeric>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

constexpr char help_of_all[] = R"(

The output folder gets a CSV file with one row for each run, and the data of the
pictures. From these, Python with pandas and matplotlib makes report.md, report.html
and the pictures. Without Python, the tool still prints medians. The same command
continues an interrupted run. It reports and skips a missing or broken pair.
Delete results of another build of the methods by hand.
Exit codes: 0 success, 2 usage, 3 a file cannot be read or written, a pair was
skipped, or there is no report.
)";

/** What --quick has in place of the defaults. */
constexpr int num_quick_points = 500;
constexpr int num_quick_baseline_runs = 60;
constexpr int num_quick_repeats = 3;

po::options_description
describeOptions(PaperStudyOptions& options)
{
  constexpr int most = 10000000;
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("data", text(options.data_folder),
     "folder of pairs: NAME/source.pcd, target.pcd and T_target_source.txt, or as its "
     "manifest.json says")
    ("pairs", list(options.pairs),
     "names of pairs, separated by commas; the default is all of the manifest, or the "
     "paper's six objects")
    ("output", outputName("folder", options.output_folder),
     "folder of the results. Runs that it already has are skipped; files of another "
     "version are refused")
    ("baseline-runs", integer(options.num_baseline_runs, 8, most),
     "number of runs of Monte Carlo ICP for each pair (the paper has 10000). A larger "
     "number later only adds runs")
    ("start-translation", positiveNumber(options.start_translation),
     "the baseline runs start within this distance on each axis [m]")
    ("start-rotation", positiveNumber(options.start_rotation),
     "the baseline runs start within this of each angle [rad]")
    ("repeats", integer(options.num_repeats, 2, most),
     "number of runs of each method from which a mean and its deviation are computed")
    ("points", integer(options.num_points, 0, most),
     "number of source points, chosen at random; 0 means all")
    ("seed", integer(options.seed, 0, max_seed), "seed of all random numbers")
    ("threads", threads(options.num_threads),
     "number of threads; 0 means as many as there are cores")
    ("quick", io::flag(options.is_quick),
     "60 baseline runs, 3 repeats and 500 points, unless given")
    ("no-report",
     "write CSV files only; the sub-command report makes the report from them")
    ("help", "show this text");
  // clang-format on
  return description;
}

/** \param[in] help is printed before the options if it is asked for
 * \param[in] unused as in NamedExperiment
 * \throws io::UsageError with a message for the user */
PaperStudyOptions
readPaperOptions(int argc,
                 const char* const* argv,
                 const std::string& help,
                 const std::vector<std::string>& unused)
{
  PaperStudyOptions options;
  const auto given = readOptions(argc, argv, describeOptions(options), help);
  for (const std::string& name : unused)
    if (!given[name].defaulted())
      throw io::UsageError("--" + name + ": has no effect on this experiment");
  options.has_report = given.count("no-report") == 0;
  const auto makeSmaller = [&](const char* name, int& count, int quick) {
    if (options.is_quick && given[name].defaulted())
      count = quick;
  };
  makeSmaller("points", options.num_points, num_quick_points);
  makeSmaller("baseline-runs", options.num_baseline_runs, num_quick_baseline_runs);
  makeSmaller("repeats", options.num_repeats, num_quick_repeats);
  return options;
}

/** Read options and pairs, make the output folder, run the experiments, and have the
 * report made; progress goes to the standard error. */
int
runExperiments(const std::string& summary,
               const std::vector<std::string>& unused,
               const std::function<void(const PaperStudy&)>& run,
               int argc,
               const char* const* argv)
{
  PaperStudy study;
  study.command = "pcl_bayesian_icp_evaluate " + io::commandOf(argc, argv);
  study.options =
      readPaperOptions(argc,
                       argv,
                       std::string("Usage: pcl_bayesian_icp_evaluate ") + argv[0] +
                           " [options]\n\n" + summary + help_of_all,
                       unused);
  io::silencePcl();
  study.pairs = readPairs(study.options, std::cerr, study.num_skipped);
  study.report = [](const std::string& line) { std::cerr << line << std::endl; };
  io::makeFolder(study.options.output_folder);
  run(study);
  if (study.num_skipped > 0)
    std::cerr << study.num_skipped << " pairs were skipped" << std::endl;
  const int report_code =
      study.options.has_report ? makeReport(study.options.output_folder) : 0;
  return study.num_skipped > 0 ? io::BadFile : report_code;
}

} // namespace

std::vector<std::uint64_t>
PaperStudyOptions::seeds() const
{
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(num_repeats));
  std::iota(seeds.begin(), seeds.end(), seed);
  return seeds;
}

std::vector<ScanPair>
readPairs(const PaperStudyOptions& options, std::ostream& log, int& num_skipped)
{
  std::vector<ScanPair> pairs;
  num_skipped = 0;
  for (const std::string& name :
       options.pairs.empty() ? pairNames(options.data_folder) : options.pairs) {
    try {
      pairs.push_back(readScanPair(options.data_folder, name));
      thinSource(pairs.back(), options.num_points);
    }
    catch (const io::FileError& error) {
      ++num_skipped;
      log << "pair " << name << " is skipped: " << error.what() << std::endl;
    }
  }
  if (pairs.empty())
    throw io::FileError(options.data_folder, "has none of the pairs");
  return pairs;
}

std::vector<SubCommand>
paperCommands()
{
  std::string summary =
      "Runs all experiments of the paper into one folder, and makes a report:";
  for (const NamedExperiment& experiment : paperExperiments())
    summary += "\n  " + experiment.name + ": " + experiment.summary;
  const auto runAll = [](const PaperStudy& study) {
    for (const NamedExperiment& experiment : paperExperiments()) {
      study.report("experiment " + experiment.name);
      experiment.run(study);
    }
  };
  const auto runner = [](const std::string& help,
                         const std::vector<std::string>& unused,
                         const std::function<void(const PaperStudy&)>& run) {
    return [=](int argc, const char* const* argv) {
      return runExperiments(help, unused, run, argc, argv);
    };
  };
  std::vector<SubCommand> commands = {
      {"paper",
       "the paper's whole evaluation: all experiments below, and a report",
       runner(summary, {}, runAll)}};
  for (const auto& [name, line, details, unused, run] : paperExperiments())
    commands.push_back({name, line, runner(details, unused, run)});
  return commands;
}

} // namespace bayesian_icp::evaluate
