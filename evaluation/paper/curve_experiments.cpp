#include "paper/draw_curves.h"

#include <io/numbers.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

/** The paper shows these two. */
const std::vector<std::string> shown_objects = {"bowl", "can"};

/** Draws that are taken after burn-in. */
constexpr int num_kept_draws = 2000;

/** Root of the prior's variance: starts as far out as the prior allows. */
constexpr double far_spread = 0.35;

DrawPart
firstDraws(int value)
{
  return {0, value};
}

DrawPart
drawsAfter(int value)
{
  return {value, num_kept_draws};
}

CurvePlan
samplesPlan()
{
  return {"samples",
          "draws",
          {{"bayesian-icp", "Bayesian ICP", "bayesian-icp"},
           {"exact", "exact", "exact"},
           {"calibrated", "calibrated", "calibrated"}},
          {100, 200, 500, 1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000},
          firstDraws};
}

CurvePlan
burnInPlan()
{
  return {"burn_in",
          "draws left out",
          {{"near", "Bayesian ICP from the guess", "bayesian-icp"},
           {"far", "Bayesian ICP from ±0.35 m, ±0.35 rad", "bayesian-icp", far_spread}},
          {0, 100, 200, 500, 1000, 1500, 2000, 3000, 4000},
          drawsAfter};
}

/** The pairs asked for, or of the six objects those that the paper shows. */
std::vector<ScanPair>
curvePairs(const PaperStudy& study)
{
  std::vector<ScanPair> pairs;
  for (const ScanPair& pair : study.pairs)
    if (std::count(shown_objects.begin(), shown_objects.end(), pair.name) > 0)
      pairs.push_back(pair);
  return pairs.empty() || !study.options.pairs.empty() ? study.pairs : pairs;
}

using Curves = std::vector<PairCurves>;

/** Lines "value, mean, standard deviation". */
std::string
curveData(const CurvePlan& plan, const PairCurves& pair, std::size_t variant, int k)
{
  std::string lines;
  for (std::size_t i = 0; i < plan.values.size(); ++i) {
    const Spread& spread = pair.spreads[variant][i][static_cast<std::size_t>(k)];
    if (spread.num_finite > 0)
      lines += std::to_string(plan.values[i]) + ' ' + io::textOf(spread.mean) + ' ' +
               io::textOf(spread.sd) + '\n';
  }
  return lines.empty() ? "0 nan nan\n" : lines;
}

void
plotCurves(const std::string& folder, const CurvePlan& plan, const Curves& curves)
{
  std::string blocks, panels = plot::panelsWithKey(curves.size(), 6);
  for (std::size_t row = 0; row < curves.size(); ++row)
    for (int k = 0; k < 6; ++k) {
      std::string plot;
      for (std::size_t v = 0; v < plan.variants.size(); ++v) {
        const std::string name =
            "curve" + std::to_string(row) + std::to_string(k) + std::to_string(v);
        blocks += plot::dataBlock(name, curveData(plan, curves[row], v, k));
        plot += (v > 0 ? ", $" : "plot $") + name +
                " with yerrorlines linewidth 1.5 pointtype 7 pointsize 0.3" +
                (row == 0 && k == 0
                     ? " title " + plot::quotedForGnuplot(plan.variants[v].title)
                     : " notitle");
      }
      panels += "set title " +
                plot::quotedForGnuplot(curves[row].pair + ", " +
                                       coordinate_names[static_cast<std::size_t>(k)]) +
                '\n' + plot + '\n';
    }
  plot::savePictures("set encoding utf8\nset datafile missing 'nan'\n" + blocks +
                         "set logscale y\nset format y '%.0e'\nset grid y\n"
                         "set xlabel '" +
                         plan.axis +
                         "'\nset ylabel 'KL [nats]'\n"
                         "set xtics rotate by -45\n" +
                         plot::pictures("1600, " + std::to_string(320 * curves.size()),
                                        panels + "unset multiplot\n"),
                     {plan.name},
                     folder);
}

ReportTable
curveTable(const CurvePlan& plan, const PairCurves& pair, std::size_t variant)
{
  ReportTable table;
  table.caption = pair.pair + ", " + plan.variants[variant].title +
                  ": KL(baseline ‖ method) [nats].";
  table.header = {plan.axis};
  table.header.insert(
      table.header.end(), coordinate_names.begin(), coordinate_names.end());
  table.header.emplace_back("6-D");
  for (std::size_t i = 0; i < plan.values.size(); ++i) {
    std::vector<std::string> row = {std::to_string(plan.values[i])};
    for (const Spread& spread : pair.spreads[variant][i])
      row.push_back(textOf(spread));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/** What both experiments are, but for their plan and words. */
ReportSection
curveExperiment(const PaperStudy& study,
                const CurvePlan& plan,
                const std::string& title,
                const std::string& text)
{
  CurveFile file(study.path(plan.name + ".csv"));
  Curves curves;
  for (const ScanPair& pair : curvePairs(study))
    curves.push_back(studyCurves(study, plan, pair, file));
  plotCurves(study.options.output_folder, plan, curves);
  ReportSection section;
  section.title = title;
  section.blocks.emplace_back(ReportText{text});
  section.blocks.emplace_back(
      ReportFigure{plan.name,
                   "KL(baseline ‖ method) [nats], mean and standard deviation over the "
                   "runs."});
  for (const PairCurves& pair : curves)
    for (std::size_t v = 0; v < plan.variants.size(); ++v)
      section.blocks.emplace_back(curveTable(plan, pair, v));
  return section;
}

} // namespace

ReportSection
samplesExperiment(const PaperStudy& study)
{
  return curveExperiment(
      study,
      samplesPlan(),
      "Number of draws",
      "Runs of 6000 draws by four chains, cut after the first draws of each. The "
      "paper: "
      "2000 to 3000 are nearly optimal. The step size of Bayesian ICP decays in the "
      "last 5 % of a run, here from draw 5700 on.");
}

ReportSection
burnInExperiment(const PaperStudy& study)
{
  return curveExperiment(
      study,
      burnInPlan(),
      "Burn-in",
      "Runs of 6000 draws by four chains: the first draws are left out, the next 2000 "
      "taken. The paper: no visible effect when the start is near. Beyond the paper: "
      "the same from chains that start as far out as the prior allows.");
}

} // namespace bayesian_icp::evaluate
