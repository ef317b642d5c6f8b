#include "paper/paper_command.h"

#include "paper/report_origin.h"

#include <io/output_folder.h>

#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

ReportSection
introduction(const PaperStudy& study)
{
  ReportSection section;
  section.title = "What this is";
  section.blocks.emplace_back(ReportText{
      "The evaluation of F. Afzal Maken, F. Ramos, L. Ott: Estimating Motion "
      "Uncertainty with Bayesian ICP, ICRA 2020 (arXiv 2004.07973), repeated. Metres, "
      "radians, nats. A pose maps source points into the target frame. Bayesian ICP is "
      "the paper's algorithm with its constants; Online-ICP its competitor, Censi's "
      "closed form in the point-to-plane form of Prakhya et al.; exact and calibrated "
      "are this project's."});
  if (study.num_skipped > 0)
    section.blocks.emplace_back(
        ReportText{std::to_string(study.num_skipped) +
                   " pairs could not be read and are not here."});
  if (study.options.is_quick)
    section.blocks.emplace_back(ReportText{
        "Made with --quick: too few runs for any conclusion, only to see that all of "
        "it works."});
  return section;
}

void
makeReport(const PaperStudy& study)
{
  ReportDocument document;
  document.title = "Bayesian ICP: the paper's evaluation";
  document.sections.push_back(introduction(study));
  for (const NamedExperiment& experiment : paperExperiments()) {
    study.report("experiment " + experiment.name);
    document.sections.push_back(experiment.run(study));
  }
  document.sections.push_back(originSection(study.options));
  io::OutputFolder folder(study.options.output_folder);
  folder.add("report.md",
             [&](std::ostream& stream) { writeMarkdown(document, stream); });
  folder.add("report.html", [&](std::ostream& stream) {
    writeHtml(document, study.options.output_folder, stream);
  });
  folder.commit();
  std::cout << study.path("report.html") << '\n';
}

} // namespace

const std::vector<NamedExperiment>&
paperExperiments()
{
  static const std::vector<NamedExperiment> experiments = {
      {"distribution",
       "the paper's Table I: divergence of every method from Monte Carlo ICP",
       "KL(baseline || method) of every method, the baseline being the results of\n"
       "Monte Carlo ICP, beside the paper's; marginal densities, pictures of the "
       "clouds,\n"
       "and scores against the true pose.",
       distributionExperiment},
      {"samples",
       "the same divergence as a function of the number of draws",
       "KL(baseline || draws) for 100 to 6000 draws; bowl and can, unless pairs are "
       "given.",
       samplesExperiment},
      {"burn-in",
       "the same divergence as a function of the length of burn-in",
       "KL(baseline || 2000 draws) after 0 to 4000 draws that are left out; bowl and "
       "can,\n"
       "unless pairs are given.",
       burnInExperiment},
      {"runtime",
       "seconds per 1000 draws, for 1, 2 and 4 threads",
       "Wall time and processor time per 1000 draws of the presets paper, exact and\n"
       "calibrated for 1, 2 and 4 threads, beside the paper's; each pair is timed as "
       "often\nas there are repeats. Run nothing else meanwhile.",
       runtimeExperiment},
      {"accuracy",
       "errors of posterior means, SGD-ICP and ICP from random starts",
       "Translation and rotation error of Bayesian ICP's mean (presets paper, exact "
       "and\n"
       "calibrated), SGD-ICP and ICP to completion, from 50 starts in ±1 m, ±0.3 rad "
       "(5 with\n--quick).",
       accuracyExperiment}};
  return experiments;
}

int
runPaperCommand(int argc, const char* const* argv)
{
  std::string summary =
      "All experiments of the paper into one folder, and a report of them, report.md\n"
      "and report.html:";
  for (const NamedExperiment& experiment : paperExperiments())
    summary += "\n  " + experiment.name + ": " + experiment.summary;
  return runExperiments({summary, makeReport}, argc, argv);
}

} // namespace bayesian_icp::evaluate
