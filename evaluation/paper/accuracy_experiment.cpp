#include "draw_statistics.h"
#include "input_hash.h"
#include "paper/accuracy_file.h"
#include "paper/accuracy_methods.h"
#include "paper/paper_experiment.h"
#include "paper/paper_table.h"

#include <bayesian_icp/calibration/twist.h>

#include <io/text_hash.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_starts = 50;
constexpr int num_quick_starts = 5;

using Runs = std::vector<AccuracyRun>;

Vector6d
startOf(const AccuracyRun::Name& name)
{
  Random random(name.seed, static_cast<std::uint64_t>(name.index));
  Vector6d start;
  for (int k = 0; k < 6; ++k)
    start[k] = (k < 3 ? accuracy_translation_range : accuracy_rotation_range) *
               (2.0 * random.uniform() - 1.0);
  return start;
}

AccuracyRun
makeRun(const PaperProblem& problem,
        const AccuracyMethod& method,
        const AccuracyRun::Name& name,
        int num_threads)
{
  const AccuracyStart start{
      startOf(name), name.seed + static_cast<std::uint64_t>(name.index), num_threads};
  const AccuracyEstimate estimate = method.run(problem, start);
  const Vector6d error = estimate.pose - poseOf(problem.pair.truth.matrix());
  AccuracyRun run{name, error.head<3>().norm(), 0.0, estimate.status};
  for (int k = 3; k < 6; ++k)
    run.rotation_error += std::abs(wrapAngle(error[k]));
  return run;
}

/** The runs of one method on one pair; those that are missing are made. */
Runs
runsOf(const PaperStudy& study,
       const PaperProblem& problem,
       const AccuracyMethod& method,
       AccuracyFile& file)
{
  Runs runs;
  int num_made = 0;
  for (int i = 0; i < (study.options.is_quick ? num_quick_starts : num_starts); ++i) {
    const AccuracyRun::Name name{io::textOfHash(problem.pair.key()),
                                 problem.pair.name,
                                 method.name,
                                 study.options.seed,
                                 i};
    if (file.find(name) == nullptr) {
      file.add(makeRun(problem, method, name, study.options.num_threads));
      ++num_made;
    }
    runs.push_back(*file.find(name));
  }
  if (num_made > 0)
    study.report("accuracy: " + problem.pair.name + ", " + method.title + ", " +
                 std::to_string(num_made) + " runs");
  return runs;
}

/** [mm] or [mrad]. */
std::vector<double>
errorsOf(const Runs& runs, double AccuracyRun::*error)
{
  std::vector<double> errors;
  for (const AccuracyRun& run : runs)
    errors.push_back(1000.0 * (run.*error));
  return errors;
}

std::string
medianText(std::vector<double> errors)
{
  errors.erase(std::remove_if(errors.begin(),
                              errors.end(),
                              [](double error) { return !std::isfinite(error); }),
               errors.end());
  return errors.empty() ? "–" : io::textOf(median(errors), 3);
}

/** One pair: the runs of each method. */
struct PairAccuracy {
  std::string pair;
  std::vector<Runs> methods;
};

ReportTable
tableOf(const PairAccuracy& accuracy)
{
  ReportTable table;
  table.caption = accuracy.pair + ": errors from " +
                  std::to_string(accuracy.methods.front().size()) + " starts.";
  table.header = {"method",
                  "translation, mean ± sd [mm]",
                  "median [mm]",
                  "rotation, mean ± sd [mrad]",
                  "median [mrad]"};
  for (std::size_t i = 0; i < accuracy.methods.size(); ++i) {
    std::vector<std::string> row = {accuracyMethods()[i].title};
    for (const auto error :
         {&AccuracyRun::translation_error, &AccuracyRun::rotation_error}) {
      const std::vector<double> errors = errorsOf(accuracy.methods[i], error);
      row.push_back(textOf(spreadOf(errors)));
      row.push_back(medianText(errors));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/** Lines "translation error, rotation error"; gnuplot leaves out what is no number. */
std::string
errorLines(const Runs& runs)
{
  std::string lines;
  for (const AccuracyRun& run : runs)
    lines +=
        io::textOf(run.translation_error) + ' ' + io::textOf(run.rotation_error) + '\n';
  return lines;
}

void
plotErrors(const std::vector<PairAccuracy>& pairs, const std::string& folder)
{
  const std::vector<AccuracyMethod>& methods = accuracyMethods();
  std::string blocks, tics = "set xtics (";
  for (std::size_t i = 0; i < methods.size(); ++i)
    tics += (i > 0 ? ", " : "") + plot::quotedForGnuplot(methods[i].name) + ' ' +
            std::to_string(i + 1);
  std::string panels = "set multiplot layout 2, " + std::to_string(pairs.size()) + '\n';
  for (const int column : {1, 2})
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      std::string plot;
      for (std::size_t i = 0; i < methods.size(); ++i) {
        const std::string name = "errors" + std::to_string(p) + '_' + std::to_string(i);
        if (column == 1)
          blocks += plot::dataBlock(name, errorLines(pairs[p].methods[i]));
        plot += (i > 0 ? ", $" : "plot $") + name + " using (" + std::to_string(i + 1) +
                "):" + std::to_string(column) + " with boxplot";
      }
      panels += "set title " + plot::quotedForGnuplot(pairs[p].pair) +
                "\nset ylabel '" +
                (column == 1 ? "translation error [m]" : "rotation error [rad]") +
                "'\n" + plot + '\n';
    }
  plot::savePictures(
      "set encoding utf8\nset datafile missing 'nan'\n" + blocks +
          "unset key\nset logscale y\nset format y '%.0e'\nset grid y\n"
          "set style fill solid 0.4\nset boxwidth 0.5\n"
          "set xtics rotate by -45\n" +
          tics + ")\n" +
          plot::pictures(
              std::to_string(std::max<std::size_t>(500, 280 * pairs.size())) + ", 760",
              panels + "unset multiplot\n"),
      {"accuracy"},
      folder);
}

ReportText
introduction()
{
  return {"From each start, uniform within ±1 m and ±0.3 rad of the pair's guess on "
          "each axis, the error of the final pose: Euclidean distance of the "
          "translations, and the sum of the absolute differences of roll, pitch and "
          "yaw. Bayesian ICP gives the mean of 2000 draws. Preset paper has the "
          "paper's prior, which is about the guess and thus knows something that the "
          "others do not; for the presets exact and calibrated the start is the guess, "
          "and the prior about it has the variance of the starts. A direction that "
          "the clouds do not hold, such as the yaw of a can, keeps the error of its "
          "start or its prior's."};
}

} // namespace

ReportSection
accuracyExperiment(const PaperStudy& study)
{
  AccuracyFile file(study.path("accuracy.csv"));
  std::vector<PairAccuracy> pairs;
  ReportSection section{"Accuracy", {introduction()}};
  for (const ScanPair& pair : study.pairs) {
    const PaperProblem problem(pair);
    pairs.push_back({pair.name, {}});
    for (const AccuracyMethod& method : accuracyMethods())
      pairs.back().methods.push_back(runsOf(study, problem, method, file));
    section.blocks.emplace_back(tableOf(pairs.back()));
  }
  plotErrors(pairs, study.options.output_folder);
  section.blocks.emplace_back(ReportFigure{
      "accuracy", "Errors of the final poses from all starts, a box a method."});
  return section;
}

} // namespace bayesian_icp::evaluate
