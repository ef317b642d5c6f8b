#include "samplers/samplers_options.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "study/option_values.h"

#include <boost/program_options.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

constexpr int max_threads = 64;

const std::vector<std::string>&
knownSamplers()
{
  static const std::vector<std::string> names = {
      "exact", "exact-metropolis", "paper", "walk", "mala"};
  return names;
}

po::options_description
description()
{
  po::options_description options("Options", 88);
  // clang-format off
  options.add_options()
    ("data", textOption("data"), "folder with one folder for each scene: source.pcd, target.pcd [m]")
    ("scenes", textOption("can,bowl,mug,table,corridor"), "names of scenes, separated by commas")
    ("cells", textOption("1:6000,0.0015:100,0.0015:1000,0.005:300"),
     "scales of the likelihood as sigma:N, separated by commas: sigma [m], effective points N")
    ("samplers", textOption("exact,exact-metropolis,paper,walk,mala"),
     "samplers to compare: exact (preset exact), exact-metropolis (the same with Metropolis "
     "steps), paper (Algorithm 1 at several step sizes; all seeds at the best one), walk and "
     "mala (full batch; covariance and starts from the gold standard)")
    ("step-sizes", textOption("1e-3,1e-4,1e-5,1e-6"),
     "step sizes alpha of Algorithm 1. Each is also tried times 6000 sigma^2 / N, which is its "
     "value at the paper's scale. Smaller ones are tried as long as they are better")
    ("seeds", intOption(5), "number of runs of each sampler, with seeds 1, 2, ...")
    ("points", intOption(2000), "number of source points, the same for all samplers and the gold standard")
    ("threads", intOption(1), "number of threads of the gold standard and the presets")
    ("gold-seconds", po::value<double>()->default_value(60.0),
     "CPU time after which a gold standard ends, even if it has not converged [s]")
    ("cache", textOption("results"), "folder of the gold standards")
    ("output", textOption("results/samplers.csv"),
     "CSV file of the results, one row for each run. Runs that it already has are skipped")
    ("report", "also make a report of all results in that folder")
    ("quick", "one scene (can), two seeds and 500 points, unless given")
    ("help", "show this text");
  // clang-format on
  return options;
}

double
positiveNumber(const std::string& text, const std::string& option)
{
  double number = 0.0;
  if (!io::readNumber(text, number) || !(number > 0.0) || !std::isfinite(number))
    throw io::UsageError("--" + option + ": " + io::quoted(text) +
                         " is not a positive number");
  return number;
}

Cell
cellOf(const std::string& text)
{
  const auto numbers = split(text, ':');
  if (numbers.size() != 2)
    throw io::UsageError("--cells: " + io::quoted(text) +
                         " is not of the form sigma:N");
  return {positiveNumber(numbers[0], "cells"), positiveNumber(numbers[1], "cells")};
}

void
makeQuick(const po::variables_map& given, SamplersOptions& options)
{
  if (given["scenes"].defaulted())
    options.scenes = {"can"};
  if (given["seeds"].defaulted())
    options.num_seeds = 2;
  if (given["points"].defaulted())
    options.num_points = 500;
}

void
takeLists(const po::variables_map& given, SamplersOptions& options)
{
  options.scenes = split(given["scenes"].as<std::string>(), ',');
  for (const auto& cell : split(given["cells"].as<std::string>(), ','))
    options.cells.push_back(cellOf(cell));
  for (const auto& step : split(given["step-sizes"].as<std::string>(), ','))
    options.step_sizes.push_back(positiveNumber(step, "step-sizes"));
  options.samplers = split(given["samplers"].as<std::string>(), ',');
  for (const auto& sampler : options.samplers)
    if (std::count(knownSamplers().begin(), knownSamplers().end(), sampler) == 0)
      throw io::UsageError("--samplers: there is no " + io::quoted(sampler));
}

} // namespace

bool
SamplersOptions::wants(const std::string& sampler) const
{
  return std::count(samplers.begin(), samplers.end(), sampler) > 0;
}

SamplersOptions
parseSamplersOptions(int argc, const char* const* argv)
{
  const po::variables_map given = readCommandLine(argc, argv, description());
  SamplersOptions options;
  options.show_help = given.count("help") > 0;
  if (options.show_help)
    return options;
  options.data_folder = given["data"].as<std::string>();
  options.cache_folder = given["cache"].as<std::string>();
  options.result_file = given["output"].as<std::string>();
  takeLists(given, options);
  options.num_seeds = integerWithin(given, "seeds", 1, 1000);
  options.num_points = integerWithin(given, "points", 10, 100000000);
  options.num_threads = integerWithin(given, "threads", 1, max_threads);
  options.has_report = given.count("report") > 0;
  if (given.count("quick") > 0)
    makeQuick(given, options);
  options.gold.num_threads = options.num_threads;
  options.gold.max_seconds = given["gold-seconds"].as<double>();
  if (!(options.gold.max_seconds > 0.0))
    throw io::UsageError("--gold-seconds must be positive");
  return options;
}

std::string
samplersHelp()
{
  std::ostringstream help;
  help
      << "Usage: pcl_bayesian_icp_evaluate samplers [options]\n\n"
         "Compares the draws of every sampler with a gold standard: long Metropolis\n"
         "runs on the same posterior, kept in the cache folder. Every run is a row of\n"
         "a CSV file: KL divergence of Gaussian moments (gold standard to sampler,\n"
         "6-D and per coordinate) [nats], Wasserstein-1 distance [standard deviations\n"
         "of the gold standard] and Kolmogorov-Smirnov distance of the marginals,\n"
         "largest R-hat, smallest bulk and tail effective sample size (ESS), CPU time\n"
         "of all threads [s], smallest bulk ESS a second, status. A table of medians\n"
         "and worst cases goes to the standard output, progress to the standard "
         "error.\n"
         "Results of another build of the samplers have to be deleted by hand.\n"
         "Exit codes: 0 good, 1 a gold standard did not converge, 2 usage, 3 cannot\n"
         "read or write a file, or make the report.\n\n"
      << description();
  return help.str();
}

} // namespace bayesian_icp::evaluate
