#include "register/export_options.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "register/choices.h"
#include "register/settings_options.h"

#include <boost/program_options/value_semantic.hpp>

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
    refuse("vertices", text, "two different whole numbers from 0 on");
}

void
takeFrame(const po::variables_map& given,
          const std::string& option,
          std::string ExportOptions::*frame,
          ExportOptions& options)
{
  if (given.count(option) == 0)
    return;
  options.*frame = given[option].as<std::string>();
  if (!options.validate().empty())
    refuse(option, options.*frame, "made of A-Z a-z 0-9 _ - . / only");
}

} // namespace

po::options_description
describeExportOptions()
{
  po::options_description group("Export");
  const auto text = [](const char* placeholder) {
    return po::value<std::string>()->value_name(placeholder);
  };
  group.add_options()("export",
                      text("LIST"),
                      ("Export the posterior mean and covariance for other software: " +
                       namesOfChoices(ExportFormat::Ros) +
                       ", separated by commas. With --output, each format becomes a "
                       "file in that folder; without it, give one format, which is "
                       "printed instead of the table. docs/exports.md has the "
                       "conventions. Without --export nothing is exported.")
                          .c_str());
  group.add_options()("target-frame",
                      text("NAME"),
                      "Name of the frame_id of ros and of the target frame of csv. "
                      "(default target)");
  group.add_options()("source-frame",
                      text("NAME"),
                      "Name of the source frame of csv. (default source)");
  group.add_options()(
      "timestamp", text("S"), "Time of ros, tum and csv [s since 1970]. (default 0)");
  group.add_options()(
      "vertices", text("I,J"), "Vertices of target and source in g2o. (default 0,1)");
  group.add_options()("export-unreliable",
                      "Also export if the status is neither ok nor doubtful. Without "
                      "it, such a posterior is not exported.");
  return group;
}

ExportRequest
readExportOptions(const po::variables_map& given)
{
  ExportRequest exports;
  if (given.count("export") == 0) {
    for (const char* option :
         {"target-frame", "source-frame", "timestamp", "vertices", "export-unreliable"})
      if (given.count(option) > 0)
        throw io::UsageError(std::string("--") + option +
                             ": has no effect without --export");
    return exports;
  }
  exports.formats = readExportFormats(given["export"].as<std::string>());
  takeFrame(given, "target-frame", &ExportOptions::target_frame, exports.options);
  takeFrame(given, "source-frame", &ExportOptions::source_frame, exports.options);
  if (given.count("timestamp") > 0)
    exports.options.timestamp_ns = readTimestamp(given["timestamp"].as<std::string>());
  if (given.count("vertices") > 0)
    takeVertices(given["vertices"].as<std::string>(), exports.options);
  exports.options.accept_unreliable = given.count("export-unreliable") > 0;
  return exports;
}

} // namespace bayesian_icp::app
