#include "coverage_command.h"

#include "coverage_cases.h"
#include "coverage_options.h"
#include "coverage_plots.h"
#include "coverage_real.h"
#include "coverage_sequences.h"
#include "coverage_study.h"
#include "coverage_table.h"
#include "formatted_text.h"

#include <boost/algorithm/string/join.hpp>

#include <io/cloud_file.h>
#include <io/errors.h>
#include <io/output_folder.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

using Names = std::vector<std::string>;

constexpr std::size_t num_quick_scenes = 2;

/** What is there to choose from, and how it is made. */
struct Offer {
  Names scenes;
  /** The cases of a scene. */
  std::function<std::vector<CoverageCaseName>(const std::string& scene)> cases;
  CoverageCaseMaker make_case;
};

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
    throw io::UsageError("--" + option + ": there is no " + io::quoted(*unknown) +
                         ", but " + boost::algorithm::join(known, " "));
  return asked.empty() ? known : asked;
}

/** Every seed in each of the conditions. */
auto
seedsIn(const Names& conditions, const CoverageOptions& options)
{
  return [conditions, num_seeds = options.num_seeds, first_seed = options.first_seed](
             const std::string& scene) {
    std::vector<CoverageCaseName> cases;
    for (const std::string& condition : conditions)
      for (int i = 0; i < num_seeds; ++i)
        cases.push_back({scene, condition, first_seed + static_cast<std::uint64_t>(i)});
    return cases;
  };
}

Offer
simulatedOffer(const CoverageOptions& options)
{
  Offer offer;
  offer.scenes = tunedScenes();
  for (const std::string& scene : newScenes())
    offer.scenes.push_back(scene);
  Names conditions = chosen(options.conditions, coverageConditions(), "conditions");
  if (options.is_quick && options.conditions.empty())
    conditions.resize(1);
  offer.cases = seedsIn(conditions, options);
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
  offer.scenes = pairs->names();
  offer.cases = seedsIn({"real"}, options);
  offer.make_case = [pairs](const CoverageCaseName& name) {
    return pairs->makeCase(name.scene, name.seed);
  };
  return offer;
}

Offer
sequenceOffer(const CoverageOptions& options)
{
  const auto pairs =
      std::make_shared<const SequencePairs>(options.real_folder, options.sequences);
  Offer offer;
  offer.scenes = pairs->names();
  offer.cases = [pairs](const std::string& scene) {
    std::vector<CoverageCaseName> cases;
    for (const std::uint64_t pair : pairs->pairs(scene))
      cases.push_back({scene, pairs->condition(scene), pair});
    return cases;
  };
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

/** The scenes asked for, `tuned` and `new` replaced by their scenes. */
Names
expanded(const CoverageOptions& options)
{
  Names scenes;
  for (const std::string& name : options.scenes) {
    const bool is_set =
        options.real_folder.empty() && (name == "tuned" || name == "new");
    const Names set = !is_set         ? Names{name}
                      : name == "new" ? newScenes()
                                      : tunedScenes();
    scenes.insert(scenes.end(), set.begin(), set.end());
  }
  return scenes;
}

CoverageStudy
studyOf(const CoverageOptions& options)
{
  const Offer offer = offerOf(options);
  Names scenes = chosen(expanded(options), offer.scenes, "scenes");
  if (options.is_quick && options.scenes.empty())
    scenes.resize(std::min(scenes.size(), num_quick_scenes));
  CoverageStudy study;
  study.make_case = offer.make_case;
  study.num_threads = options.num_threads;
  Names known;
  for (const CoverageMethod& method : coverageMethods())
    known.push_back(method.name);
  const Names methods = chosen(options.methods, known, "methods");
  for (const CoverageMethod& method : coverageMethods())
    if (std::count(methods.begin(), methods.end(), method.name) > 0)
      study.methods.push_back(method);
  for (const std::string& scene : scenes)
    for (CoverageCaseName& name : offer.cases(scene))
      study.cases.push_back(std::move(name));
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
  const CoverageOptions options = parseCoverageOptions(argc, argv);
  if (options.show_help) {
    std::cout << coverageHelp();
    return 0;
  }
  io::silencePcl();
  if (!options.plot_folder.empty()) {
    plot::requireGnuplot("--plots");
    const io::OutputFolder can_be_written(options.plot_folder);
  }
  CoverageStudy study = studyOf(options);
  study.report = reportProgress;
  CoverageFile results(options.result_file);
  runCoverageStudy(study, results);
  const auto runs = runsOf(study, results);
  printCoverageTable(runs, std::cout);
  if (!options.plot_folder.empty())
    plotCoverage(runs, options.plot_folder);
  return 0;
}

} // namespace bayesian_icp::evaluate
