#include "commands.h"
#include "coverage/coverage_cases.h"
#include "coverage/coverage_options.h"
#include "coverage/coverage_real.h"
#include "coverage/coverage_sequences.h"
#include "coverage/coverage_study.h"
#include "coverage/coverage_table.h"
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/errors.h"
#include "io/folders.h"
#include "study/formatted_text.h"
#include "study/report_program.h"

#include <boost/algorithm/string/join.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <numeric>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

using Names = std::vector<std::string>;

constexpr std::size_t num_quick_scenes = 2;

/** Scenes that are seen under the same conditions. */
struct SceneSet {
  /** Stands for all of them on the command line, unless it is empty. */
  std::string name;
  Names scenes;
  Names conditions;
  /** Those that have to be asked for. */
  Names rare_conditions;
  /** Whether they are run where none are asked for. */
  bool is_default;
};

/** What is there to choose from, and how it is made. */
struct Offer {
  std::vector<SceneSet> sets;
  /** The seeds of a scene's cases, in each of its conditions. */
  std::function<std::vector<std::uint64_t>(const std::string& scene)> seeds;
  CoverageCaseMaker make_case;
};

/** Those asked for, whatever the scene. */
auto
seedsOf(const CoverageOptions& options)
{
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(options.num_seeds));
  std::iota(seeds.begin(), seeds.end(), options.first_seed);
  return [seeds](const std::string&) { return seeds; };
}

Offer
simulatedOffer(const CoverageOptions& options)
{
  Offer offer;
  offer.seeds = seedsOf(options);
  offer.sets = {
      {"tuned", tunedScenes(), coverageConditions(), furtherConditions(), true},
      {"new", newScenes(), coverageConditions(), furtherConditions(), true},
      {"lidar", lidarScenes(), lidarConditions(), {}, false}};
  offer.make_case = [](const CoverageCaseName& name) {
    return makeCoverageCase(name.scene, name.condition, name.seed);
  };
  return offer;
}

Offer
realOffer(const CoverageOptions& options)
{
  const auto pairs = std::make_shared<const RealPairs>(options.real_folder);
  Offer offer;
  offer.sets = {{"", pairs->names(), {"real"}, {}, true}};
  offer.seeds = seedsOf(options);
  offer.make_case = [pairs](const CoverageCaseName& name) {
    return pairs->makeCase(name.scene, name.seed);
  };
  return offer;
}

/** Of recordings: the seed of a case is the number of its pair. */
Offer
sequenceOffer(const CoverageOptions& options)
{
  const auto pairs =
      std::make_shared<const SequencePairs>(options.real_folder, options.sequences);
  Offer offer;
  for (const std::string& name : pairs->names())
    offer.sets.push_back({"", {name}, {pairs->condition(name)}, {}, true});
  offer.seeds = [pairs](const std::string& scene) { return pairs->pairs(scene); };
  offer.make_case = [pairs](const CoverageCaseName& name) {
    return pairs->makeCase(name.scene, name.seed);
  };
  return offer;
}

Offer
offerOf(const CoverageOptions& options)
{
  if (options.real_folder.empty())
    return simulatedOffer(options);
  return options.has_sequences ? sequenceOffer(options) : realOffer(options);
}

/** The names asked for, all of \p known if none are.
 * \throws io::UsageError of one that is not known */
Names
chosen(const Names& asked, const Names& known, const std::string& option)
{
  const auto unknown =
      std::find_if(asked.begin(), asked.end(), [&known](const std::string& name) {
        return std::count(known.begin(), known.end(), name) == 0;
      });
  if (unknown != asked.end())
    throw io::UsageError("--" + option + ": there is no " + io::inQuotes(*unknown) +
                         ", but " + boost::algorithm::join(known, " "));
  return asked.empty() ? known : asked;
}

/** Append those of \p more that \p names does not have yet. */
void
addMissing(Names& names, const Names& more)
{
  for (const std::string& name : more)
    if (std::count(names.begin(), names.end(), name) == 0)
      names.push_back(name);
}

/** The scenes asked for, the name of a set replaced by its scenes. */
Names
expanded(const Names& asked, const Offer& offer)
{
  Names scenes;
  for (const std::string& name : asked) {
    const auto set = std::find_if(
        offer.sets.begin(), offer.sets.end(), [&name](const SceneSet& candidate) {
          return candidate.name == name && !name.empty();
        });
    addMissing(scenes, set == offer.sets.end() ? Names{name} : set->scenes);
  }
  return scenes;
}

/** The scenes asked for; without any, those of the default sets, or the first few. */
Names
scenesOf(const CoverageOptions& options, const Offer& offer)
{
  Names known;
  Names usual;
  for (const SceneSet& set : offer.sets) {
    addMissing(known, set.scenes);
    if (set.is_default)
      addMissing(usual, set.scenes);
  }
  if (!options.scenes.empty())
    return chosen(expanded(options.scenes, offer), known, "scenes");
  if (options.is_quick)
    usual.resize(std::min(usual.size(), num_quick_scenes));
  return usual;
}

/** The conditions asked for that \p scene is seen under; without any, all of them, or
 * the first.
 * \throws io::UsageError if there is none */
Names
conditionsOf(const CoverageOptions& options,
             const Offer& offer,
             const std::string& scene)
{
  const auto set =
      std::find_if(offer.sets.begin(), offer.sets.end(), [&scene](const SceneSet& s) {
        return std::count(s.scenes.begin(), s.scenes.end(), scene) > 0;
      });
  Names conditions = set->conditions;
  if (!options.conditions.empty()) {
    Names known = set->conditions;
    addMissing(known, set->rare_conditions);
    conditions.clear();
    for (const std::string& name : options.conditions)
      if (std::count(known.begin(), known.end(), name) > 0)
        conditions.push_back(name);
    if (conditions.empty())
      throw io::UsageError("--conditions: " + io::inQuotes(scene) + " has only " +
                           boost::algorithm::join(known, " "));
  }
  else if (options.is_quick)
    conditions.resize(1);
  return conditions;
}

std::vector<CoverageMethod>
methodsOf(const CoverageOptions& options)
{
  Names known;
  for (const CoverageMethod& method : coverageMethods())
    known.push_back(method.name);
  Names named;
  std::vector<CoverageMethod> of_exact;
  for (const std::string& name : options.methods)
    if (name.rfind("exact:", 0) == 0)
      io::readOption("methods", [&] { of_exact.push_back(exactMethod(name)); });
    else
      named.push_back(name);
  if (named.empty() && !of_exact.empty())
    return of_exact;
  const Names names = chosen(named, known, "methods");
  std::vector<CoverageMethod> methods;
  for (const CoverageMethod& method : coverageMethods())
    if (std::count(names.begin(), names.end(), method.name) > 0)
      methods.push_back(method);
  methods.insert(methods.end(), of_exact.begin(), of_exact.end());
  return methods;
}

CoverageStudy
studyOf(const CoverageOptions& options)
{
  const Offer offer = offerOf(options);
  const Names scenes = scenesOf(options, offer);
  Names known_conditions;
  for (const SceneSet& set : offer.sets) {
    addMissing(known_conditions, set.conditions);
    addMissing(known_conditions, set.rare_conditions);
  }
  chosen(options.conditions, known_conditions, "conditions");
  CoverageStudy study;
  study.make_case = offer.make_case;
  study.num_threads = options.num_threads;
  study.methods = methodsOf(options);
  for (const std::string& scene : scenes)
    for (const std::string& condition : conditionsOf(options, offer, scene))
      for (const std::uint64_t seed : offer.seeds(scene))
        study.cases.push_back({scene, condition, seed});
  return study;
}

void
reportProgress(const CoverageProgress& progress)
{
  std::cerr << format("%zu of %zu cases, about %.0f s left (%s, %s, seed %llu)",
                      progress.num_done,
                      progress.num_cases,
                      progress.seconds_left,
                      progress.last_case.scene.c_str(),
                      progress.last_case.condition.c_str(),
                      static_cast<unsigned long long>(progress.last_case.seed))
            << std::endl;
}

/** The rows of the study, in its order. */
std::vector<CoverageRun>
runsOf(const CoverageStudy& study, const CoverageFile& results)
{
  std::vector<CoverageRun> runs;
  for (const CoverageCaseName& name : study.cases)
    for (const CoverageMethod& method : study.methods)
      if (const CoverageRun* run =
              results.find({name.scene, name.condition, name.seed, method.name}))
        runs.push_back(*run);
  return runs;
}

} // namespace

int
runCoverageCommand(int argc, const char* const* argv)
{
  const std::optional<CoverageOptions> options = parseCoverageOptions(argc, argv);
  if (!options)
    return 0;
  io::silencePcl();
  CoverageStudy study = studyOf(*options);
  study.report = reportProgress;
  CoverageFile results(options->result_file);
  runCoverageStudy(study, results);
  const auto runs = runsOf(study, results);
  printCoverageTable(runs, std::cout);
  return options->has_report ? makeReport(io::folderOf(options->result_file)) : 0;
}

} // namespace bayesian_icp::evaluate
