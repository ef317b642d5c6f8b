#include "coverage_options.h"

#include "option_values.h"

#include <boost/program_options.hpp>

#include <io/errors.h>

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
     "simulated scenes: tuned (on which the method was tuned), new (not tuned on), lidar (a car's "
     "or robot's spinning lidar of up to 64 rings, 80 m), or names with commas between; with "
     "--real, names of pairs. Without it, tuned and new, or all pairs")
    ("conditions", textOption(""),
     "conditions with commas between, of which every scene takes its own: lidar scenes have "
     "lidar16, lidar32, lidar64 (rings) and lidar64_sweep (moving during each scan); without it, "
     "all")
    ("methods", textOption(""), "methods with commas between; without it, all")
    ("seeds", intOption(20), "cases of each scene and condition")
    ("first-seed", intOption(1), "seed of the first of them")
    ("real", textOption(""),
     "folder of real pairs with a manifest.json, in place of the simulated scenes: every seed "
     "is another random part of the source and another pose drawn from the pair's prior")
    ("output", textOption("evaluation/coverage.csv"),
     "results, a row a run; runs that are there are not made again")
    ("plots", textOption(""), "folder of plots (SVG and PNG, made by gnuplot); without it, none")
    ("threads", intOption(0), "cases at a time; 0: as many as there are cores")
    ("quick", "two scenes or pairs, one condition, three seeds, unless they are given")
    ("help", "show this text");
  // clang-format on
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
  options.plot_folder = text("plots");
  options.num_seeds = integerWithin(given, "seeds", 1, 1000000);
  options.first_seed = seedOf(given, "first-seed");
  options.num_threads = numThreadsOf(given);
  if (options.result_file.empty())
    throw io::UsageError("--output needs the name of a file");
  if (!options.real_folder.empty() && !options.conditions.empty())
    throw io::UsageError("--conditions is of simulated scenes, not of --real");
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
         "about the source's centroid, time, nearest-neighbour queries, flags. A "
         "table\n"
         "goes to the standard output, progress to the standard error.\n"
         "Results of another build of the methods have to be deleted by hand.\n"
         "Exit codes: 0 good, 2 usage, 3 cannot read or write a file.\n\n"
      << description();
  return help.str();
}

} // namespace bayesian_icp::evaluate
