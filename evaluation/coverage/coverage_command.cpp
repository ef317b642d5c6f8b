#include "commands.h"
#include "coverage/coverage_cases.h"
#include "coverage/coverage_options.h"
#include "coverage/coverage_real.h"
#include "coverage/coverage_sequences.h"
#include "coverage/coverage_study.h"
#include "coverage/coverage_summary.h"
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/errors.h"
#include "study/formatted_text.h"

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

bool
contains(const Names& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/** Append those of \p more that \p names does not have yet. */
void
addMissing(Names& names, const Names& more)
{
  for (const std::string& name : more)
    if (!contains(names, name))
      names.push_back(name);
}

/** \throws io::UsageError of a name asked for that is not known */
void
requireKnown(const Names& asked, const Names& known, const std::string& option)
{
  for (const std::string& name : asked)
    if (!contains(known, name))
      throw io::UsageError("--" + option + ": there is no " + io::inQuotes(name) +
                           ", but " + boost::algorithm::join(known, " "));
}

/** The scenes asked for, the name of a set replaced by its scenes; without any, those
 * of the default sets, or the first few. */
Names
scenesOf(const CoverageOptions& options, const Offer& offer)
{
  Names known, usual, asked;
  for (const SceneSet& set : offer.sets) {
    addMissing(known, set.scenes);
    if (set.is_default)
      addMissing(usual, set.scenes);
  }
  for (const std::string& name : options.scenes) {
    const auto set =
        std::find_if(offer.sets.begin(), offer.sets.end(), [&name](const SceneSet& s) {
          return s.name == name && !name.empty();
        });
    addMissing(asked, set == offer.sets.end() ? Names{name} : set->scenes);
  }
  requireKnown(asked, known, "scenes");
  if (!asked.empty())
    return asked;
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
        return contains(s.scenes, scene);
      });
  if (options.conditions.empty())
    return options.is_quick ? Names{set->conditions.front()} : set->conditions;
  Names known = set->conditions, chosen;
  addMissing(known, set->rare_conditions);
  for (const std::string& name : options.conditions)
    if (contains(known, name))
      chosen.push_back(name);
  if (chosen.empty())
    throw io::UsageError("--conditions: " + io::inQuotes(scene) + " has only " +
                         boost::algorithm::join(known, " "));
  return chosen;
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
  requireKnown(named, known, "methods");
  std::vector<CoverageMethod> methods;
  for (const CoverageMethod& method : coverageMethods())
    if (named.empty() || contains(named, method.name))
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
  requireKnown(options.conditions, known_conditions, "conditions");
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
reportProgress(const StudyProgress& progress, const CoverageCaseName& last)
{
  std::cerr << format("%zu of %zu cases, about %.0f s left (%s, %s, seed %llu)",
                      progress.num_done,
                      progress.num_all,
                      progress.seconds_left,
                      last.scene.c_str(),
                      last.condition.c_str(),
                      static_cast<unsigned long long>(last.seed))
            << std::endl;
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
  CoverageFile results(options->result.file);
  runCoverageStudy(study, results);
  printCoverageTable(runsOf(study, results), std::cout);
  return options->result.report();
}

} // namespace bayesian_icp::evaluate
