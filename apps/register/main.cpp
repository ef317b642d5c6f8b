/** \file
 * \brief pcl_bayesian_icp: registers a cloud to another and tells how sure that is.
 */
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/program.h"
#include "register/cloud_notes.h"
#include "register/command_line.h"
#include "register/export_files.h"
#include "register/posterior_files.h"
#include "register/progress_bar.h"
#include "register/report_text.h"
#include "register/sgd_run.h"
#include "report/report_html.h"

#include <bayesian_icp/measurement.h>

#include <optional>

namespace bayesian_icp::app {
namespace {

Run
runRegistration(const Request& request)
{
  io::silencePcl();
  Run run = readRun(request.source_file, request.target_file, request.settings);
  // PCL registers coordinates of 32 bits.
  if (!request.is_quiet)
    for (const std::string& note : {io::noteOfLostDigits(run.source),
                                    io::noteOfLostDigits(run.target),
                                    noteOfZeros(run.source),
                                    noteOfZeros(run.target),
                                    noteOfSize(run.source, run.settings)})
      io::tell(note);
  io::catchInterrupt();
  registerWithBar(!request.is_quiet, run);
  return run;
}

/** The posterior, or what the clouds alone determine if that is asked for. */
PoseEstimate
exportedEstimate(const Request& request, const Run& run)
{
  const PoseEstimate posterior(run.result.summary);
  if (!request.exports.is_without_prior)
    return posterior;
  const PoseMeasurement measurement = withoutPrior(posterior, run.result.prior);
  if (measurement.num_unmeasured > 0 && hasUsableMean(posterior.status) &&
      !request.is_quiet)
    io::tell("--export-without-prior: the clouds do not determine " +
             std::to_string(measurement.num_unmeasured) +
             " of 6 directions; their standard deviation is " +
             io::fixedTextOf(unmeasured_deviation, 0) + " times the prior's");
  return measurement.estimate;
}

/** \return whether it can be exported */
bool
printExport(const Request& request, const Run& run)
{
  const std::string& format = request.exports.formats.front();
  try {
    io::print(
        exportText(format, exportedEstimate(request, run), request.exports.options));
    return true;
  }
  catch (const std::invalid_argument& error) {
    io::tell("--export " + format + ": " + error.what());
    return false;
  }
}

/** \return whether all that was asked for could be exported */
bool
writeFiles(const Request& request, const Run& run, io::OutputFolder& folder)
{
  const auto refusals =
      addExports(request.exports, exportedEstimate(request, run), folder);
  if (request.wants_report)
    addReport([&] { return reportHtml(run, request.command); }, folder);
  else
    folder.leaveOut("report.html");
  folder.add("aligned.pcd", [&](std::ostream& stream) {
    io::writeAligned(run.source, run.target, run.result.final_matrix, stream);
  });
  addPosteriorFiles(run, folder);
  folder.commit();
  for (const std::string& refusal : refusals)
    io::tell(refusal);
  return refusals.empty();
}

/** Without draws there is posterior.json alone, which says why. No file of an older
 * result stays beside it. */
void
writeFailure(const Run& run, io::OutputFolder& folder)
{
  leaveOutExports(folder);
  for (const char* name : {"aligned.pcd", "report.html"})
    folder.leaveOut(name);
  addPosteriorFiles(run, folder);
  folder.commit();
  io::tell("there are no draws, so no files but posterior.json are written");
}

/** \return whether all that was asked for could be exported */
bool
report(const Request& request, const Run& run)
{
  const bool prints_export =
      !request.exports.formats.empty() && request.output_folder.empty();
  const bool has_table = !prints_export && !request.is_json && !request.is_quiet;
  if (request.is_json)
    io::print(posteriorJson(run));
  else if (has_table)
    io::print(reportText(run));
  const bool is_exported = !prints_export || printExport(request, run);
  // The table has the status and the note already.
  if (run.result.summary.status != Status::Ok && !has_table)
    io::tell(statusText(run.result.summary));
  if (!has_table && !request.output_folder.empty()) {
    const std::string note = icpNote(run);
    if (!note.empty())
      io::tell("warning: " + note);
  }
  return is_exported;
}

int
registerAsAsked(const Request& request)
{
  if (!request.settings.note.empty() && !request.is_quiet)
    io::tell("note: " + request.settings.note);
  std::optional<io::OutputFolder> folder;
  if (!request.output_folder.empty())
    folder.emplace(request.output_folder);
  const Run run = runRegistration(request);
  const bool has_draws = run.result.summary.num_draws > 0;
  bool is_exported = true;
  if (folder && has_draws)
    is_exported = writeFiles(request, run, *folder);
  else if (folder && run.result.summary.status != Status::Cancelled)
    writeFailure(run, *folder);
  else if (folder)
    io::tell("there are no draws, so no files are written");
  is_exported &= report(request, run);
  if (io::wasInterrupted())
    return io::Interrupted;
  const bool is_good = run.result.summary.status == Status::Ok && is_exported;
  return is_good ? io::Good : io::NotGood;
}

int
runTool(int argc, char** argv)
{
  const Request request = parseCommandLine(argc, argv);
  return request.sgd ? runSgdIcp(request) : registerAsAsked(request);
}

} // namespace
} // namespace bayesian_icp::app

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp", [&] { return app::runTool(argc, argv); });
}
