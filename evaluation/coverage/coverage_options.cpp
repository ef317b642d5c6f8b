#include "coverage/coverage_options.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "study/option_values.h"

#include <boost/program_options.hpp>

#include <cmath>
#include <sstream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

po::options_description
description()
{
  po::options_description options("Options", 88);
  // clang-format off
  options.add_options()
    ("scenes", textOption(""),
     "simulated scenes: tuned (on which the method was tuned), new (not used in tuning), lidar (a "
     "spinning lidar of up to 64 rings and 80 m on a car or robot), or names separated by commas. "
     "With --real: names of pairs or recordings. The default is tuned and new, or all that is real")
    ("conditions", textOption(""),
     "conditions, separated by commas; every scene takes those that it has. Lidar scenes have "
     "lidar16, lidar32, lidar64 (rings) and lidar64_sweep (the sensor moves during each scan). "
     "The default is all conditions of the scenes except far (the true pose is 1 m and 0.8 rad "
     "off, and the prior is as wide), points_quarter, points_x4, points_x16 and points_x64 (both "
     "clouds have that many times the points)")
    ("methods", textOption(""), "methods, separated by commas; the default is all")
    ("seeds", intOption(20), "number of cases of each scene and condition")
    ("first-seed", intOption(1), "seed of the first case; with recordings, seed of all guesses")
    ("real", textOption(""),
     "folder of real scans, which replace the simulated scenes. If it has a manifest.json, it has "
     "pairs, and each seed takes another random part of the source and another pose from the "
     "pair's prior. Otherwise it has recordings: one folder for each, with set.json, poses.txt "
     "and scan_0000.pcd, scan_0001.pcd, ... (docs/calibration.md)")
    ("step", intOption(1), "with recordings: number of scans from the target to the source")
    ("pairs", intOption(0), "largest number of pairs of each recording, evenly spread; 0 means all")
    ("guess-sd", textOption("0.1,0.03"),
     "with recordings: standard deviations of the guesses, along and about each axis of the "
     "sensor [m, rad]")
    ("rows", textOption(""),
     "file with pairs of recordings, their guesses and truths, which replace random guesses. "
     "Each line is a JSON object with set, pair (the target's number), guess and truth (3x4; the "
     "source is turned as the truth requires)")
    ("output", textOption("results/coverage.csv"),
     "CSV file of the results, one row for each run. Runs that it already has are skipped")
    ("report", "also make a report, with figures, of all results in that folder")
    ("threads", intOption(0), "number of cases that run at the same time; 0 means as many as there are cores")
    ("quick",
     "two scenes, pairs or recordings, one condition, and three seeds or pairs, unless given")
    ("help", "show this text");
  // clang-format on
  return options;
}

AxisDeviation
deviationOf(const std::string& text)
{
  const auto items = split(text, ',');
  AxisDeviation sd;
  if (items.size() != 2 || !io::readNumber(items[0], sd.translation) ||
      !io::readNumber(items[1], sd.rotation) || !(sd.translation >= 0.0) ||
      !(sd.rotation >= 0.0) || std::isinf(sd.translation + sd.rotation))
    throw io::UsageError("--guess-sd is " + io::quoted(text) +
                         ", but must be two numbers [m, rad], not negative, separated "
                         "by a comma");
  return sd;
}

/** \throws io::UsageError of an option that has no meaning for what is run */
void
refuseMisplaced(const po::variables_map& given, const CoverageOptions& options)
{
  const auto refuse = [&given](const std::string& name, const std::string& reason) {
    if (!given[name].defaulted())
      throw io::UsageError("--" + name + " is " + reason);
  };
  if (!options.real_folder.empty())
    refuse("conditions", "of simulated scenes, not of --real");
  if (options.has_sequences)
    refuse("seeds", "not of recordings, of which every pair is a case: see --pairs");
  else
    for (const char* name : {"step", "pairs", "guess-sd", "rows"})
      refuse(name, "of recordings only: see --real");
}

SequenceOptions
sequenceOptionsOf(const po::variables_map& given)
{
  constexpr int most = 1000000;
  constexpr int num_quick_pairs = 3;
  SequenceOptions options;
  options.step = static_cast<std::size_t>(integerWithin(given, "step", 1, most));
  options.max_pairs = static_cast<std::size_t>(integerWithin(given, "pairs", 0, most));
  if (given.count("quick") > 0 && given["pairs"].defaulted())
    options.max_pairs = num_quick_pairs;
  options.guess_sd = deviationOf(given["guess-sd"].as<std::string>());
  options.seed = seedOf(given, "first-seed");
  options.rows_file = given["rows"].as<std::string>();
  return options;
}

} // namespace

CoverageOptions
parseCoverageOptions(int argc, const char* const* argv)
{
  const po::variables_map given = readCommandLine(argc, argv, description());
  CoverageOptions options;
  options.show_help = given.count("help") > 0;
  if (options.show_help)
    return options;
  const auto text = [&given](const char* name) {
    return given[name].as<std::string>();
  };
  options.scenes = split(text("scenes"), ',');
  options.conditions = split(text("conditions"), ',');
  options.methods = split(text("methods"), ',');
  options.result_file = text("output");
  options.real_folder = text("real");
  options.has_report = given.count("report") > 0;
  options.num_seeds = integerWithin(given, "seeds", 1, 1000000);
  options.first_seed = seedOf(given, "first-seed");
  options.num_threads = numThreadsOf(given);
  if (options.result_file.empty())
    throw io::UsageError("--output needs the name of a file");
  options.has_sequences =
      !options.real_folder.empty() && !hasManifest(options.real_folder);
  options.sequences = sequenceOptionsOf(given);
  refuseMisplaced(given, options);
  options.is_quick = given.count("quick") > 0;
  if (options.is_quick && given["seeds"].defaulted())
    options.num_seeds = 3;
  return options;
}

std::string
coverageHelp()
{
  std::ostringstream help;
  help
      << "Usage: pcl_bayesian_icp_evaluate coverage [options]\n\n"
         "Is the posterior as wide as it should be? Registers pairs of scans whose "
         "true\n"
         "pose was drawn from the prior, by every method, and compares each posterior\n"
         "with the truth. Every run is a row of a CSV file: squared Mahalanobis\n"
         "distance of the truth (NEES), log score [nats] and energy score in units of\n"
         "the prior's standard deviations, probability integral transforms (PIT),\n"
         "errors, standard scores and deviations of the six coordinates of a twist\n"
         "about the source's centroid, mean displacement of the source's points [m],\n"
         "time, nearest-neighbour queries, flags. A table goes to the standard "
         "output,\n"
         "progress to the standard error.\n"
         "Of recordings the prior is the default one about a guess, log scores are in\n"
         "metres and radians and at least -50 a pair, and the table counts lost pairs\n"
         "(displaced by more than the recording's limit; they are left out of "
         "NEES/6),\n"
         "alarms (flags on good ones: not lost, NEES below 16.812) and misses (bad "
         "ones\n"
         "without a flag: lost, or NEES above 27.856).\n"
         "Results of another build of the methods have to be deleted by hand.\n"
         "Exit codes: 0 good, 2 usage, 3 cannot read or write a file, or make the "
         "report.\n\n"
      << description();
  return help.str();
}

} // namespace bayesian_icp::evaluate
