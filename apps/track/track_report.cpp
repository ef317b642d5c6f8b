#include "track/track_report.h"

#include "io/time_stamps.h"
#include "report/path_charts.h"
#include "report/section.h"

#include <array>
#include <filesystem>

namespace bayesian_icp::app {

namespace {

constexpr std::size_t max_rows_of_table = 100;

std::vector<Chart>
uncertaintyCharts(const Track& track)
{
  static constexpr const char* x_label = "time [s]";
  std::vector<double> times;
  std::string innovations;
  for (std::size_t k = 0; k < track.poses().size(); ++k) {
    times.push_back(io::secondsOf(track.times()[k] - track.times()[0]));
    if (k == 0)
      continue;
    const int num_measured = 6 - track.steps()[k - 1].edge.num_unmeasured;
    if (num_measured > 0)
      innovations += plotNumber(times[k]) + ' ' +
                     plotNumber(track.innovations()[k - 1] / num_measured) + '\n';
  }
  std::vector<Chart> charts = deviationCharts(times, x_label, {track.poses(), {}, {}});
  charts.push_back(lineChart(
      "innovation",
      "Squared difference between prediction and registration, in units of what both "
      "covariances allow. About 1 on average is right. If it is far above 1, "
      "--acceleration or --angular-acceleration is too small.",
      x_label,
      "per direction",
      plot::dataBlock("data", innovations.empty() ? "0 1\n" : innovations) +
          "set logscale y\nset arrow from graph 0, first 1 to graph 1, first 1 "
          "nohead dashtype 2\nplot $data using 1:2 with linespoints pointtype 7 "
          "pointsize 0.3 linecolor rgb '" +
          path_colour + "'\n"));
  return charts;
}

std::string
verdictHtml(const Track& track)
{
  std::array<std::size_t, 4> counts{}; // by StepKind
  for (const TrackStep& step : track.steps())
    ++counts[static_cast<std::size_t>(step.kind)];
  const std::size_t num_steps = track.steps().size();
  const bool is_good = counts[0] == num_steps;
  std::string sentence = io::textOf(num_steps) + " scans after scan 0";
  for (std::size_t k = 0; k < counts.size(); ++k)
    sentence += (k == 0 ? ": " : ", ") + io::textOf(counts[k]) + ' ' +
                toString(static_cast<StepKind>(k));
  const std::string unmeasured = unmeasuredText(track.numUnmeasured(), num_steps);
  if (!unmeasured.empty())
    sentence += ". " + unmeasured + " (edges.jsonl names the motions)";
  return html::boxHtml(is_good && unmeasured.empty() ? html::Tone::Good
                       : counts[2] + counts[3] == 0  ? html::Tone::Caution
                                                     : html::Tone::Bad,
                       !is_good ? "Not every scan is registered with status ok"
                       : unmeasured.empty()
                           ? "Every scan is registered"
                           : "Every scan is registered, but not every motion measured",
                       html::paragraphHtml(sentence + '.'));
}

std::string
tableOfProblems(const TrackCommand& command, const Track& track)
{
  html::Table table;
  table.caption = "Scans that are not registered with status ok";
  table.header = {"scan", "file", "target", "became", "status", "message"};
  table.first_column_of_words = 1;
  for (const TrackStep& step : track.steps())
    if (step.kind != StepKind::Registered) {
      const std::filesystem::path file =
          command.request.scans.at(static_cast<std::size_t>(step.scan));
      table.rows.push_back({io::textOf(step.scan),
                            file.filename().string(),
                            io::textOf(step.edge.target),
                            toString(step.kind),
                            step.status,
                            step.message});
    }
  return html::limitedTableHtml(table, max_rows_of_table, "more are in edges.jsonl.");
}

} // namespace

std::string
trackReportHtml(const TrackCommand& command, const Track& track)
{
  const Section path = {"trajectory",
                        "Where was the sensor?",
                        "",
                        {pathChart({track.poses(), {}, {}})},
                        tableOfProblems(command, track)};
  const Section uncertainty = {
      "uncertainty",
      "How certain is it?",
      html::paragraphHtml(
          "Errors add up along the trajectory. The covariances treat a quarter of a "
          "registration's variance as the noise of each of its two scans, a fifth as "
          "an error of registrations along the same motion, and the rest as "
          "independent."),
      uncertaintyCharts(track)};
  const Section repeat = {"repeat", "To repeat the run", commandHtml(command.command)};
  return html::pageHtml("Track of " + io::textOf(track.poses().size()) + " scans",
                        verdictHtml(track) + sectionsHtml({path, uncertainty, repeat}));
}

} // namespace bayesian_icp::app
