/** \file
 * \brief pcl_bayesian_icp_track: the trajectory of a sensor from its scans.
 */
#include "graph/trajectory_files.h"
#include "io/cloud_file.h"
#include "io/interrupt.h"
#include "io/line_file.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "io/time_stamps.h"
#include "register/cloud_notes.h"
#include "report/path_charts.h"
#include "report/section.h"
#include "track/track_command.h"
#include "track/track_line.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <array>
#include <filesystem>

namespace bayesian_icp::app {
namespace {

/** The steps that an interrupted track has left.
 * \return whether it is one: its files have not changed */
bool
takeLine(const std::string& file,
         const std::string& line,
         const TrackRequest& request,
         Track& track)
{
  try {
    const TrackStep step = readTrackLine(line, request, track.size());
    const std::string state = request.filesState(step.scan);
    if (!state.empty() && state != step.files_state)
      return false;
    track.take(step);
    return true;
  }
  catch (const std::exception& error) {
    throw io::FileError(file,
                        "line " + io::textOf(track.size()) +
                            " does not belong to this track: " + error.what() +
                            "; use another folder, or remove the file");
  }
}

void
tellStep(const TrackCommand& command, const TrackStep& step)
{
  const bool is_good = step.kind == StepKind::Registered;
  if (is_good && command.is_quiet)
    return;
  const std::string file = command.request.scans.at(std::size_t(step.scan));
  io::tell(io::textOf(step.scan) + '/' + io::textOf(command.request.scans.size() - 1) +
           ' ' + std::filesystem::path(file).filename().string() + ": " +
           toString(step.kind) + " (" + io::fixedTextOf(step.seconds, 2) + " s)" +
           (is_good ? "" : ", " + step.status + ": " + step.message));
}

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

/** A self-contained HTML page: the trajectory and how sure it is. */
std::string
reportHtml(const TrackCommand& command, const Track& track)
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

void
writeFiles(const TrackCommand& command, const Track& track, io::OutputFolder& folder)
{
  folder.add("trajectory_tum.txt", tumText(track.times(), track.poses()));
  folder.add("trajectory_covariance.txt",
             tumCovarianceText(track.times(), track.poses()));
  folder.add("graph.g2o", g2oText(track.poses(), track.edges()));
  addReport([&] { return reportHtml(command, track); }, folder);
  folder.commit();
}

/** Give memory that is free back to the system: what a step keeps lies between what a
 * registration has freed, so that the heap grows by ten times what is in use. */
void
trimMemory(int num_scans)
{
  constexpr int scans_between = 100;
  if (num_scans % scans_between != 0)
    return;
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

int
makeTrack(const TrackCommand& command)
{
  const TrackRequest& request = command.request;
  if (!command.request.settings.note.empty() && !command.is_quiet)
    io::tell("note: " + command.request.settings.note);
  io::silencePcl();
  io::OutputFolder folder(command.output_folder);
  const MotionModel model = motionModelOf(request);
  if (model.plane_normal && !command.is_quiet)
    io::tell(plane_note);
  Track track(model, request.times, request.voxel_size > 0.0 ? request.map_scans : 1);
  const std::string edges =
      (std::filesystem::path(command.output_folder) / "edges.jsonl").string();
  bool has_changed = false;
  const io::LineFile file(edges, [&](const std::string& line) {
    has_changed = has_changed || !takeLine(edges, line, request, track);
    return !has_changed;
  });
  if (has_changed)
    io::tell("scan 0 or " + io::textOf(track.size()) +
             " has changed, so the track goes on from scan " +
             io::textOf(track.size()));
  if (track.size() > 1 && !command.is_quiet)
    io::tell(io::textOf(track.size() - 1) + " of " +
             io::textOf(request.scans.size() - 1) + " steps are in " + edges +
             " already");
  if (!command.is_quiet)
    tellNotesOfFirst(request.scans.front(), request.settings);
  io::catchInterrupt();
  Tracker tracker(request, track);
  while (track.size() < static_cast<int>(request.scans.size()) &&
         !io::wasInterrupted()) {
    const auto step =
        tracker.registerNext([](const Progress&) { return !io::wasInterrupted(); });
    if (!step)
      break;
    track.take(*step);
    file.add(trackLine(request, track));
    tellStep(command, *step);
    trimMemory(track.size());
  }
  writeFiles(command, track, folder);
  if (io::wasInterrupted()) {
    io::tell("interrupted; the same command goes on");
    return io::Interrupted;
  }
  io::tell(unmeasuredText(track.numUnmeasured(), track.steps().size()));
  const bool are_all_good = std::all_of(
      track.steps().begin(), track.steps().end(), [](const TrackStep& step) {
        return step.kind == StepKind::Registered;
      });
  return are_all_good ? io::Good : io::NotGood;
}

} // namespace
} // namespace bayesian_icp::app

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp_track", [&] {
    return app::makeTrack(app::parseTrackCommand(argc, argv));
  });
}
