#include "paper/paper_options.h"

#include "io/errors.h"
#include "study/option_values.h"

#include <boost/program_options.hpp>

#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

/** What --quick has in place of the defaults. */
constexpr int num_quick_points = 500;
constexpr int num_quick_baseline_runs = 60;
constexpr int num_quick_repeats = 3;

double
positiveNumber(const po::variables_map& given, const std::string& name)
{
  const double value = given[name].as<double>();
  if (!(value > 0.0) || !std::isfinite(value))
    throw io::UsageError("--" + name + " must be positive");
  return value;
}

/** The value of an option that --quick makes smaller unless it is given. */
int
countOf(const po::variables_map& given, const std::string& name, int least, int quick)
{
  constexpr int most = 10000000;
  const bool is_quick = given.count("quick") > 0 && given[name].defaulted();
  return is_quick ? quick : integerWithin(given, name, least, most);
}

} // namespace

po::options_description
paperOptionsDescription()
{
  po::options_description options("Options", 88);
  // clang-format off
  options.add_options()
    ("data", textOption("data"),
     "folder of pairs: NAME/source.pcd, target.pcd and T_target_source.txt, or as its "
     "manifest.json says")
    ("pairs", textOption(""),
     "names of pairs, separated by commas; the default is all of the manifest, or the paper's "
     "six objects")
    ("output", textOption("results/paper"),
     "folder of the results. Runs that it already has are skipped")
    ("baseline-runs", intOption(1000),
     "number of runs of Monte Carlo ICP for each pair (the paper has 10000). A larger number "
     "later only adds runs")
    ("start-translation", po::value<double>()->default_value(1.0, "1"),
     "these runs start within this distance on each axis [m] ...")
    ("start-rotation", po::value<double>()->default_value(1.0, "1"),
     "... and within this of each angle [rad]")
    ("repeats", intOption(10), "number of runs of each method behind a mean and its deviation")
    ("points", intOption(0), "number of source points, chosen at random; 0 means all")
    ("seed", intOption(1), "seed of all random numbers")
    ("threads", intOption(0), "number of threads; 0 means as many as there are cores")
    ("quick", "60 baseline runs, 3 repeats and 500 points, unless given")
    ("no-report", "write CSV files only; the sub-command report makes the report from them")
    ("help", "show this text");
  // clang-format on
  return options;
}

PaperStudyOptions
paperOptionsOf(const po::variables_map& given)
{
  PaperStudyOptions options;
  options.show_help = given.count("help") > 0;
  if (options.show_help)
    return options;
  options.data_folder = given["data"].as<std::string>();
  options.pairs = split(given["pairs"].as<std::string>(), ',');
  options.output_folder = given["output"].as<std::string>();
  if (options.output_folder.empty())
    throw io::UsageError("--output needs the name of a folder");
  options.is_quick = given.count("quick") > 0;
  options.has_report = given.count("no-report") == 0;
  options.seed = seedOf(given, "seed");
  options.num_threads = numThreadsOf(given);
  options.num_points = countOf(given, "points", 0, num_quick_points);
  options.num_baseline_runs =
      countOf(given, "baseline-runs", 8, num_quick_baseline_runs);
  options.num_repeats = countOf(given, "repeats", 2, num_quick_repeats);
  options.start_translation = positiveNumber(given, "start-translation");
  options.start_rotation = positiveNumber(given, "start-rotation");
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
