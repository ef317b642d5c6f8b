#include "paper/paper_experiment.h"
#include "study/option_values.h"

#include <numeric>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

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
     "folder of the results. Runs that it already has are skipped")
    ("baseline-runs", integer(options.num_baseline_runs, 8, most),
     "number of runs of Monte Carlo ICP for each pair (the paper has 10000). A larger "
     "number later only adds runs")
    ("start-translation", positiveNumber(options.start_translation),
     "these runs start within this distance on each axis [m] ...")
    ("start-rotation", positiveNumber(options.start_rotation),
     "... and within this of each angle [rad]")
    ("repeats", integer(options.num_repeats, 2, most),
     "number of runs of each method behind a mean and its deviation")
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

} // namespace

std::vector<std::uint64_t>
PaperStudyOptions::seeds() const
{
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(num_repeats));
  std::iota(seeds.begin(), seeds.end(), seed);
  return seeds;
}

std::optional<PaperStudyOptions>
readPaperOptions(int argc, const char* const* argv, const std::string& help)
{
  PaperStudyOptions options;
  const auto given = readOptions(argc, argv, describeOptions(options), help);
  if (!given)
    return std::nullopt;
  options.has_report = given->count("no-report") == 0;
  const auto makeSmaller = [&](const char* name, int& count, int quick) {
    if (options.is_quick && (*given)[name].defaulted())
      count = quick;
  };
  makeSmaller("points", options.num_points, num_quick_points);
  makeSmaller("baseline-runs", options.num_baseline_runs, num_quick_baseline_runs);
  makeSmaller("repeats", options.num_repeats, num_quick_repeats);
  return options;
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

} // namespace bayesian_icp::evaluate
