#include "sbc/sbc_options.h"

#include "io/errors.h"
#include "study/option_values.h"

#include <boost/program_options.hpp>

#include <algorithm>
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
    ("sampler", textOption(""),
     "exact-langevin, exact-metropolis, calibrated, calibrated-scans, or several of them, "
     "separated by commas; exact means the first two. The default is all")
    ("runs", intOption(500), "number of runs of each sampler")
    ("seed", intOption(1), "seed of the first run")
    ("output", textOption("results/sbc.csv"),
     "CSV file of the results, one row for each run. Runs that it already has are skipped")
    ("report", "also make a report, with figures, of all results in that folder")
    ("threads", intOption(0), "number of runs at the same time; 0 means as many as there are cores")
    ("help", "show this text");
  // clang-format on
  return options;
}

} // namespace

SbcOptions
parseSbcOptions(int argc, const char* const* argv)
{
  const po::variables_map given = readCommandLine(argc, argv, description());
  SbcOptions options;
  options.show_help = given.count("help") > 0;
  if (options.show_help)
    return options;
  for (const std::string& name : split(given["sampler"].as<std::string>(), ','))
    if (name == "exact")
      options.samplers.insert(options.samplers.end(),
                              {"exact-langevin", "exact-metropolis"});
    else
      options.samplers.push_back(name);
  options.num_runs = integerWithin(given, "runs", 1, 1000000);
  options.first_seed = seedOf(given, "seed");
  options.result_file = given["output"].as<std::string>();
  options.has_report = given.count("report") > 0;
  options.num_threads = numThreadsOf(given);
  if (options.result_file.empty())
    throw io::UsageError("--output needs the name of a file");
  return options;
}

std::string
sbcHelp()
{
  std::ostringstream help;
  help
      << "Usage: pcl_bayesian_icp_evaluate sbc [options]\n\n"
         "Simulation-based calibration: are the draws of a sampler draws of the\n"
         "posterior? True poses are drawn from the prior and data from the very\n"
         "likelihood; the rank of the true pose among 99 draws is then uniform, in\n"
         "each of the six coordinates. calibrated-scans ranks true poses of simulated\n"
         "scans, of which the likelihood is no exact model. Every run is a row of a\n"
         "CSV file. A table goes to the standard output, progress to the standard\n"
         "error. Results of another build have to be deleted by hand.\n"
         "Exit codes: 0 good, 1 ranks are not uniform or draws are no good, 2 usage,\n"
         "3 cannot read or write a file, or make the report.\n\n"
      << description();
  return help.str();
}

} // namespace bayesian_icp::evaluate
