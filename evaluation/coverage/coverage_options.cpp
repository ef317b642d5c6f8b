#include "coverage/coverage_options.h"

#include "register/choices.h"

#include <cmath>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

constexpr char coverage_help[] = R"(Usage: pcl_bayesian_icp_evaluate coverage [options]

Is the posterior as wide as it should be? Registers pairs of scans whose true
pose was drawn from the prior, by every method, and compares each posterior
with the truth. Every run is a row of a CSV file: squared Mahalanobis
distance of the truth (NEES), log score [nats] and energy score in units of
the prior's standard deviations, probability integral transforms (PIT),
errors, standard scores and deviations of the six coordinates of a twist
about the source's centroid, mean displacement of the source's points [m],
time, nearest-neighbour queries, flags. A table goes to the standard output,
progress to the standard error.
Of recordings the prior is the default one about a guess, log scores are in
metres and radians and at least -50 a pair, and the table counts lost pairs
(displaced by more than the recording's limit; they are left out of NEES/6),
alarms (flags on good ones: not lost, NEES below 16.812) and misses (bad ones
without a flag: lost, or NEES above 27.856).
Results of another build of the methods have to be deleted by hand.
Exit codes: 0 good, 2 usage, 3 cannot read or write a file, or make the report.
)";

AxisDeviation
deviationOf(const std::string& text)
{
  const auto items = split(text, ',');
  AxisDeviation sd;
  if (items.size() != 2 || !io::readNumber(items[0], sd.translation) ||
      !io::readNumber(items[1], sd.rotation) || !(sd.translation >= 0.0) ||
      !(sd.rotation >= 0.0) || std::isinf(sd.translation + sd.rotation))
    throw io::BadValue(" is " + io::inQuotes(text) +
                       ", but must be two numbers [m, rad], not negative, separated by "
                       "a comma");
  return sd;
}

po::options_description
describeOptions(CoverageOptions& options)
{
  SequenceOptions& sequences = options.sequences;
  constexpr int most = 1000000;
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("scenes", list(options.scenes),
     "simulated scenes: tuned (on which the method was tuned), new (not used in "
     "tuning), lidar (a spinning lidar of up to 64 rings and 80 m on a car or robot), "
     "or names separated by commas. With --real: names of pairs or recordings. The "
     "default is tuned and new, or all that is real")
    ("conditions", list(options.conditions),
     "conditions, separated by commas; every scene takes those that it has. Lidar "
     "scenes have lidar16, lidar32, lidar64 (rings) and lidar64_sweep (the sensor "
     "moves during each scan). The default is all conditions of the scenes except far "
     "(the true pose is 1 m and 0.8 rad off, and the prior is as wide), "
     "points_quarter, points_x4, points_x16 and points_x64 (both clouds have that many "
     "times the points)")
    ("methods", list(options.methods),
     ("methods, separated by commas; the default is all that have a name. Preset exact "
      "is exact:RESIDUAL:STEPS:SIGMA:N:POINTS, with sigma [m], N effective points and "
      "at most so many source points: residual " +
      app::namesOfChoices(Residual()) + ", steps " + app::namesOfChoices(ExactSteps()))
         .c_str())
    ("seeds", integer(options.num_seeds, 1, most),
     "number of cases of each scene and condition")
    ("first-seed", integer(options.first_seed, 0, max_seed),
     "seed of the first case; with recordings, seed of all guesses")
    ("real", text(options.real_folder),
     "folder of real scans, which replace the simulated scenes. If it has a "
     "manifest.json, it has pairs, and each seed takes another random part of the "
     "source and another pose from the pair's prior. Otherwise it has recordings: one "
     "folder for each, with set.json, poses.txt and scan_0000.pcd, scan_0001.pcd, ... "
     "(docs/calibration.md)")
    ("step", integer(sequences.step, 1, most),
     "with recordings: number of scans from the target to the source")
    ("pairs", integer(sequences.max_pairs, 0, most),
     "largest number of pairs of each recording, evenly spread; 0 means all")
    ("guess-sd", taken("0.1,0.03", [&sequences](const std::string& text) {
       sequences.guess_sd = deviationOf(text);
     }),
     "with recordings: standard deviations of the guesses, along and about each axis "
     "of the sensor [m, rad]")
    ("rows", text(sequences.rows_file),
     "file with pairs of recordings, their guesses and truths, which replace random "
     "guesses. Each line is a JSON object with set, pair (the target's number), guess "
     "and truth (3x4; the source is turned as the truth requires)")
    ("threads", threads(options.num_threads),
     "number of cases that run at the same time; 0 means as many as there are cores")
    ("quick", io::flag(options.is_quick),
     "two scenes, pairs or recordings, one condition, and three seeds or pairs, unless "
     "given");
  // clang-format on
  addResultOptions(options.result, description);
  return description;
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

} // namespace

std::optional<CoverageOptions>
parseCoverageOptions(int argc, const char* const* argv)
{
  constexpr int num_quick_cases = 3;
  CoverageOptions options;
  const auto given = readOptions(argc, argv, describeOptions(options), coverage_help);
  if (!given)
    return std::nullopt;
  options.sequences.seed = options.first_seed;
  options.has_sequences =
      !options.real_folder.empty() && !hasManifest(options.real_folder);
  refuseMisplaced(*given, options);
  if (options.is_quick && (*given)["seeds"].defaulted())
    options.num_seeds = num_quick_cases;
  if (options.is_quick && (*given)["pairs"].defaulted())
    options.sequences.max_pairs = num_quick_cases;
  return options;
}

} // namespace bayesian_icp::evaluate
