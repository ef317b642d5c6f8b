#include "register/export_options.h"

#include "io/command_line.h"
#include "register/choices.h"

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

/** Two different numbers from 0 on, the target's vertex and the source's. */
void
takeVertices(const std::string& text, ExportOptions& options)
{
  const auto items = io::splitAt(',', text);
  if (items.size() != 2 || !io::readNumber(items[0], options.target_vertex) ||
      !io::readNumber(items[1], options.source_vertex) || !options.validate().empty())
    io::refuseValue(text, "two different whole numbers from 0 on");
}

/** An option that is the name of a frame. */
po::typed_value<std::string>*
frame(std::string ExportOptions::*frame, ExportOptions& options)
{
  return io::taken("NAME", [frame, &options](const std::string& name) {
    options.*frame = name;
    if (!options.validate().empty())
      io::refuseValue(name, "made of A-Z a-z 0-9 _ - . / only");
  });
}

} // namespace

po::options_description
describeExportOptions(ExportRequest& exports)
{
  ExportOptions& options = exports.options;
  const std::string formats =
      "Export the posterior mean and covariance for other software: " +
      namesOfChoices(ExportFormat::Ros) +
      ", separated by commas. With --output, each format becomes a file in that "
      "folder; without it, give one format, which is printed instead of the table. "
      "docs/exports.md has the conventions. Without --export nothing is exported.";
  po::options_description group("Export");
  // clang-format off
  group.add_options()
    ("export", io::taken("LIST", [&exports](const std::string& list) {
       exports.formats = readExportFormats(list);
     }),
     formats.c_str())
    ("target-frame", frame(&ExportOptions::target_frame, options),
     "Name of the frame_id of ros and of the target frame of csv. (default target)")
    ("source-frame", frame(&ExportOptions::source_frame, options),
     "Name of the source frame of csv. (default source)")
    ("timestamp", io::taken("S", [&options](const std::string& seconds) {
       options.timestamp_ns = readTimestamp(seconds);
     }),
     "Time of ros, tum and csv [s since 1970]. (default 0)")
    ("vertices", io::taken("I,J", [&options](const std::string& vertices) {
       takeVertices(vertices, options);
     }),
     "Vertices of target and source in g2o. (default 0,1)")
    ("export-unreliable", io::flag(options.accept_unreliable),
     "Also export if the status is neither ok nor doubtful. Without it, such a "
     "posterior is not exported.");
  // clang-format on
  return group;
}

void
refuseExportOptionsWithoutExport(const po::variables_map& given)
{
  if (given.count("export") > 0)
    return;
  for (const char* option :
       {"target-frame", "source-frame", "timestamp", "vertices", "export-unreliable"})
    if (given.count(option) > 0)
      throw io::UsageError(std::string("--") + option +
                           ": has no effect without --export");
}

} // namespace bayesian_icp::app
