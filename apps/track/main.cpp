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
#include "register/cloud_notes.h"
#include "report/section.h"
#include "track/track_command.h"
#include "track/track_line.h"
#include "track/track_report.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
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

void
writeFiles(const TrackCommand& command, const Track& track, io::OutputFolder& folder)
{
  folder.add("trajectory_tum.txt", tumText(track.times(), track.poses()));
  folder.add("trajectory_covariance.txt",
             tumCovarianceText(track.times(), track.poses()));
  folder.add("graph.g2o", g2oText(track.poses(), track.edges()));
  addReport([&] { return trackReportHtml(command, track); }, folder);
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
  if (!command.note.empty() && !command.is_quiet)
    io::tell("note: " + command.note);
  io::silencePcl();
  io::OutputFolder folder(command.output_folder);
  Track track(motionModelOf(request),
              request.times,
              request.voxel_size > 0.0 ? request.map_scans : 1);
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
    const auto command = app::parseTrackCommand(argc, argv);
    return command ? app::makeTrack(*command) : io::Good;
  });
}
