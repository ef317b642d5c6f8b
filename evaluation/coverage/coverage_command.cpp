#include "commands.h"
#include "coverage/coverage_cases.h"
#include "coverage/coverage_real.h"
#include "coverage/coverage_study.h"
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "register/choices.h"
#include "study/named.h"
#include "study/option_values.h"

#include <boost/algorithm/string/join.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

/** What is run, and where it is kept. */
struct CoverageOptions {
  /** Names as given; empty: all there are, but for the scenes of the set lidar. */
  std::vector<std::string> scenes;
  std::vector<std::string> conditions;
  std::vector<std::string> methods;
  int num_seeds = 20;
  std::uint64_t first_seed = 1;
  ResultOptions result = {"results/coverage.csv"};
  /** Folder of real pairs with a manifest.json, or of recordings; empty: simulated
   * scenes. */
  std::string real_folder;
  bool has_sequences = false;
  SequenceOptions sequences;
  int num_threads = 1;
  /** Few scenes and one condition where none are given. */
  bool is_quick = false;
};

constexpr char coverage_help[] = R"(Usage: pcl_bayesian_icp_evaluate coverage [options]

Is the posterior as wide as it should be? Registers pairs of scans, whose true
pose is drawn from the prior, with every method, and compares each posterior
with the truth. Each run is a row of a CSV file: squared Mahalanobis distance
of the truth (NEES), log score [nats] and energy score in units of the prior's
standard deviations, probability integral transforms (PIT), errors, standard
scores and deviations of the six coordinates of a twist about the source's
centroid, mean displacement of the source's points [m], time,
nearest-neighbour queries, flags. A summary goes to standard output: shares and
means, medians of errors, time and queries; "outside": flagged runs of those
with the truth outside the 95 % region. Progress goes to standard error.
For recordings, the prior is the default one about a guess, with the source's
centroid as its origin. Log scores are in metres and radians, and at least -50
for a pair. The summary has the shares of lost pairs (displaced by more than
the recording's limit; NEES/6 leaves them out), alarms (flags on good pairs:
not lost, NEES below 16.812) and misses (bad pairs without a flag: lost, or
NEES above 27.856).
Rows of the same names but other scans, truths or guesses do not count. Delete
results of another build of the methods by hand.
Exit codes: 0 success, 2 usage, 3 a file cannot be read or written, or the
report cannot be made.
)";

AxisDeviation
deviationOf(const std::string& text)
{
  std::array<double, 2> sd;
  if (!io::readNumbers(text, sd) || !(sd[0] >= 0.0) || !(sd[1] >= 0.0) ||
      std::isinf(sd[0] + sd[1]))
    throw io::BadValue(" is " + io::inQuotes(text) +
                       ", but must be two numbers [m, rad], not negative, separated by "
                       "a comma");
  return {sd[0], sd[1]};
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
     "(the true pose is 1 m and 0.8 rad off, and the prior is as wide), clean_target "
     "and exact_target (a tenth of the noise in the target, and none), points_quarter, "
     "points_x4, points_x16 and points_x64 (both clouds have that many times the "
     "points), and lidar1 (a 2-D laser scanner)")
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
  if (!options.sequences.rows_file.empty())
    for (const char* name : {"guess-sd", "first-seed"})
      refuse(name, "of random guesses, which --rows replaces");
}

/** \throws io::UsageError with a message for the user */
CoverageOptions
readCoverageOptions(int argc, const char* const* argv)
{
  constexpr int num_quick_cases = 3;
  CoverageOptions options;
  const auto given = readOptions(argc, argv, describeOptions(options), coverage_help);
  options.sequences.seed = options.first_seed;
  options.has_sequences =
      !options.real_folder.empty() && !hasManifest(options.real_folder);
  refuseMisplaced(given, options);
  if (options.is_quick && given["seeds"].defaulted())
    options.num_seeds = num_quick_cases;
  if (options.is_quick && given["pairs"].defaulted())
    options.sequences.max_pairs = num_quick_cases;
  return options;
}

using Names = std::vector<std::string>;

constexpr std::size_t num_quick_scenes = 2;

/** A scene, and the cases that there are of it. */
struct OfferedScene {
  std::string name;
  /** Stands for all scenes that have it on the command line, unless it is empty. */
  std::string set;
  Names conditions;
  /** Those that have to be asked for. */
  Names rare_conditions;
  /** Of its cases, in each of its conditions. */
  std::vector<std::uint64_t> seeds;
};

/** What is there to choose from, and how it is made. */
struct Offer {
  std::vector<OfferedScene> scenes;
  CoverageCaseMaker make_case;
};

/** Has to be asked for. */
constexpr char lidar_set[] = "lidar";

Offer
simulatedOffer(const std::vector<std::uint64_t>& seeds)
{
  Offer offer;
  for (const auto& [set, names] :
       {std::pair("tuned", tunedScenes()), std::pair("new", newScenes())})
    for (const std::string& name : names)
      offer.scenes.push_back(
          {name, set, coverage_conditions, further_conditions, seeds});
  for (const std::string& name : lidar_scenes)
    offer.scenes.push_back(
        {name, lidar_set, lidar_conditions, further_lidar_conditions, seeds});
  offer.make_case = [](const CoverageCaseName& name) {
    return makeCoverageCase(name.scene, name.condition, name.seed);
  };
  return offer;
}

Offer
realOffer(const std::string& folder, const std::vector<std::uint64_t>& seeds)
{
  const std::vector<ManifestEntry> pairs = readManifest(folder);
  Offer offer;
  for (const ManifestEntry& pair : pairs) {
    if (!pair.prior_sd)
      throw io::FileError(folder + "/" + manifest_name,
                          "has no suggested_prior_sigma of " + io::inQuotes(pair.name));
    offer.scenes.push_back({pair.name, "", {real_pair}, {}, seeds});
  }
  offer.make_case = [folder, pairs](const CoverageCaseName& name) {
    return makeRealCase(folder, *findNamed(pairs, name.scene), name.seed);
  };
  return offer;
}

/** Of recordings: the seed of a case is the number of its pair. */
Offer
sequenceOffer(const std::string& folder, const SequenceOptions& options)
{
  const auto pairs = std::make_shared<const SequencePairs>(folder, options);
  Offer offer;
  for (const std::string& name : pairs->names())
    offer.scenes.push_back(
        {name, "", {pairs->condition(name)}, {}, pairs->pairs(name)});
  offer.make_case = [pairs](const CoverageCaseName& name) {
    return pairs->makeCase(name.scene, name.seed);
  };
  return offer;
}

Offer
offerOf(const CoverageOptions& options)
{
  if (options.has_sequences)
    return sequenceOffer(options.real_folder, options.sequences);
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(options.num_seeds));
  std::iota(seeds.begin(), seeds.end(), options.first_seed);
  return options.real_folder.empty() ? simulatedOffer(seeds)
                                     : realOffer(options.real_folder, seeds);
}

bool
contains(const Names& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/** The scenes asked for by their names or those of their sets; without any, those that
 * need not be asked for, or the first few. */
std::vector<OfferedScene>
scenesOf(const CoverageOptions& options, const Offer& offer)
{
  std::vector<OfferedScene> chosen;
  for (const std::string& asked : options.scenes) {
    bool is_known = false;
    for (const OfferedScene& scene : offer.scenes) {
      if (scene.name != asked && scene.set != asked)
        continue;
      is_known = true;
      if (findNamed(chosen, scene.name) == nullptr)
        chosen.push_back(scene);
    }
    if (!is_known)
      io::readOption("scenes", [&] { requireKnown({asked}, namesOf(offer.scenes)); });
  }
  if (!options.scenes.empty())
    return chosen;
  for (const OfferedScene& scene : offer.scenes)
    if (scene.set != lidar_set &&
        !(options.is_quick && chosen.size() == num_quick_scenes))
      chosen.push_back(scene);
  return chosen;
}

/** The conditions asked for that \p scene is seen under; without any, all of them, or
 * the first.
 * \throws io::UsageError if there is none */
Names
conditionsOf(const CoverageOptions& options, const OfferedScene& scene)
{
  if (options.conditions.empty())
    return options.is_quick ? Names{scene.conditions.front()} : scene.conditions;
  Names known = scene.conditions, chosen;
  known.insert(known.end(), scene.rare_conditions.begin(), scene.rare_conditions.end());
  for (const std::string& name : options.conditions)
    if (contains(known, name))
      chosen.push_back(name);
  if (chosen.empty())
    throw io::UsageError("--conditions: " + io::inQuotes(scene.name) + " has only " +
                         boost::algorithm::join(known, " "));
  return chosen;
}

std::vector<CoverageMethod>
methodsOf(const CoverageOptions& options)
{
  const std::vector<CoverageMethod> known = coverageMethods();
  Names named;
  std::vector<CoverageMethod> of_exact;
  for (const std::string& name : options.methods)
    if (name.rfind("exact:", 0) == 0)
      io::readOption("methods", [&] { of_exact.push_back(exactMethod(name)); });
    else
      named.push_back(name);
  if (named.empty() && !of_exact.empty())
    return of_exact;
  io::readOption("methods", [&] { requireKnown(named, namesOf(known)); });
  std::vector<CoverageMethod> methods;
  for (const CoverageMethod& method : known)
    if (named.empty() || contains(named, method.name))
      methods.push_back(method);
  methods.insert(methods.end(), of_exact.begin(), of_exact.end());
  return methods;
}

CoverageStudy
studyOf(const CoverageOptions& options)
{
  const Offer offer = offerOf(options);
  const std::vector<OfferedScene> scenes = scenesOf(options, offer);
  Names known_conditions;
  for (const OfferedScene& scene : offer.scenes)
    for (const Names& names : {scene.conditions, scene.rare_conditions})
      for (const std::string& name : names)
        if (!contains(known_conditions, name))
          known_conditions.push_back(name);
  io::readOption("conditions",
                 [&] { requireKnown(options.conditions, known_conditions); });
  CoverageStudy study;
  study.make_case = offer.make_case;
  study.num_threads = options.num_threads;
  study.methods = methodsOf(options);
  for (const OfferedScene& scene : scenes)
    for (const std::string& condition : conditionsOf(options, scene))
      for (const std::uint64_t seed : scene.seeds) {
        CoverageCaseName name{scene.name, condition, seed};
        if (!options.real_folder.empty())
          name.inputs = study.make_case(name).key();
        study.cases.push_back(name);
      }
  if (study.cases.empty())
    throw io::FileError(options.real_folder, "has no two scans to register");
  return study;
}

} // namespace

int
runCoverageCommand(int argc, const char* const* argv)
{
  const CoverageOptions options = readCoverageOptions(argc, argv);
  io::silencePcl();
  const CoverageStudy study = studyOf(options);
  CoverageFile results(options.result.file);
  runCoverageStudy(study, results);
  std::cout << summaryOf(runsOf(study, results));
  return options.result.report();
}

} // namespace bayesian_icp::evaluate
