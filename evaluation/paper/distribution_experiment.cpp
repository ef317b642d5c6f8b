#include "paper/distribution_plots.h"

#include <algorithm>

namespace bayesian_icp::evaluate {

namespace {

void
addTables(const std::vector<ReportTable>& tables, ReportSection& section)
{
  section.blocks.insert(section.blocks.end(), tables.begin(), tables.end());
}

void
plotPair(const PaperStudy& study,
         const PaperProblem& problem,
         const PaperBaseline& baseline)
{
  const std::string& folder = study.options.output_folder;
  const NamedDraws methods = shownDraws(problem, study.options);
  plotDensities(folder, problem.pair.name, baseline, methods);
  plotClouds(folder, problem.pair, methods);
}

ReportSection
sectionOf(const Distributions& distributions)
{
  ReportSection section;
  section.title = "Distribution (Table I)";
  const auto say = [&section](const std::string& text) {
    section.blocks.emplace_back(ReportText{text});
  };
  say("How far is the distribution that a method reports from the baseline, where "
      "standard ICP ends from random starts? KL is that of Gaussian moments, "
      "KL(baseline ‖ method), angles unwrapped about the baseline's circular mean. The "
      "paper says neither its direction nor its density estimate, and its scans are "
      "others: its absolute values cannot come out, its orders can.");
  section.blocks.emplace_back(baselineTable(distributions));
  addTables(comparisonTables(distributions), section);
  section.blocks.emplace_back(ReportFigure{
      "divergences",
      "KL(baseline ‖ method) [nats] per coordinate: mean over the runs of each method. "
      "Infinite ones are not drawn."});
  say("Did the chains sample their posterior? At the paper's step size they do not: "
      "their spread is that of the step size, not of the likelihood (exact draws from "
      "the same posterior), and the status says so.");
  section.blocks.emplace_back(mixingTable(distributions));
  addTables(divergenceTables(distributions), section);
  say("Beyond the paper: the truth is known here, and a distribution near the baseline "
      "is not yet a right one. Where ICP from a good start ends is far less uncertain "
      "than where it ends from starts within a metre and a radian.");
  addTables(scoreTables(distributions), section);
  for (const PairDistribution& pair : distributions) {
    const std::string& name = pair.pair->name;
    section.blocks.emplace_back(
        ReportFigure{"densities_" + name,
                     name + ": marginal densities (kernel estimates, each scaled to a "
                            "largest value of 1) of baseline and methods."});
    section.blocks.emplace_back(ReportFigure{
        "clouds_" + name, name + ": target and source before and after [m]."});
  }
  return section;
}

} // namespace

ReportSection
distributionExperiment(const PaperStudy& study)
{
  DistributionFile file(study.path("distribution.csv"));
  Distributions distributions;
  for (const ScanPair& pair : study.pairs) {
    const PaperProblem problem(pair);
    distributions.push_back(studyDistribution(study, problem, file));
    plotPair(study, problem, distributions.back().baseline);
  }
  plotDivergences(study.options.output_folder, distributions);
  return sectionOf(distributions);
}

} // namespace bayesian_icp::evaluate
