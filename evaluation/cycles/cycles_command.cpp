#include "commands.h"
#include "graph/closed_cycles.h"
#include "graph/trajectory_files.h"
#include "io/coordinates.h"
#include "io/folders.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "study/option_values.h"
#include "study/run_file.h"
#include "study/text_table.h"

#include <algorithm>
#include <filesystem>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

using app::ClosedCycle;
using app::Closure;
using app::CycleStatistics;
using app::GraphEdge;

namespace {

/** Probability below which the errors of all cycles together are not chance. */
constexpr double min_chance = 0.001;
constexpr std::size_t max_lines = 20;

struct CyclesOptions {
  int max_length = 4;
  app::SharedNoise shared;
  ResultOptions result{"results/cycles.csv"};
};

std::string
csvOf(const std::vector<ClosedCycle>& cycles)
{
  CsvRow header;
  for (const std::string title :
       {"vertices", "length", "squared_error", "num_degrees", "probability"})
    header.add(title);
  for (std::size_t k = 0; k < twist_names.size(); ++k)
    header.add(std::string("error_") + twist_names[k] + (k < 3 ? "_m" : "_rad"));
  std::string text = header.text() + '\n';
  for (const ClosedCycle& closed : cycles) {
    CsvRow row;
    row.add(closed.vertices)
        .add(closed.length())
        .add(closed.closure.squared_error)
        .add(closed.closure.num_degrees)
        .add(closed.closure.probability);
    for (const double error : closed.closure.error)
      row.add(error);
    text += row.text() + '\n';
  }
  return text;
}

std::string
tableOf(const std::vector<ClosedCycle>& cycles)
{
  std::string text = "length    cycles  degrees  NEES/degree   50 %   95 %\n";
  for (const CycleStatistics& line : app::statisticsOf(cycles))
    text += format("%-8s %7zu %9.2f %13.2f %6.2f %6.2f\n",
                   line.name.c_str(),
                   line.num_cycles,
                   line.num_degrees,
                   line.nees_per_degree,
                   line.share_in_half,
                   line.share_in_95);
  return text;
}

std::string
jointText(const app::JointClosure& joint)
{
  return format("%zu independent cycles together: squared error %.1f for %d degrees of "
                "freedom, probability %.2g\n",
                joint.num_cycles,
                joint.squared_error,
                joint.num_degrees,
                joint.probability);
}

std::string
suspectsText(const std::vector<GraphEdge>& edges,
             const std::vector<ClosedCycle>& cycles)
{
  std::string text;
  for (const app::Suspect& suspect : app::suspectsOf(cycles)) {
    const GraphEdge& edge = edges[suspect.edge];
    text += "  " + io::textOf(edge.target) + '-' + io::textOf(edge.source) + ": all " +
            io::textOf(suspect.num_cycles) + " cycles\n";
  }
  return text.empty() ? text : "Edges none of whose cycles closes:\n" + text;
}

std::string
failuresText(const std::vector<ClosedCycle>& cycles)
{
  const std::vector<ClosedCycle> open = app::openCycles(cycles);
  std::string text;
  for (std::size_t k = 0; k < std::min(open.size(), max_lines); ++k) {
    const Closure& closure = open[k].closure;
    text += "  " + open[k].vertices +
            format(": %.3g m, %.3g rad; NEES %.3g of %d degrees, probability %.2g\n",
                   closure.error.head<3>().norm(),
                   closure.error.tail<3>().norm(),
                   closure.squared_error,
                   closure.num_degrees,
                   closure.probability);
  }
  if (open.size() > max_lines)
    text += "  and " + io::textOf(open.size() - max_lines) + " more\n";
  return text.empty() ? text : "Cycles that do not close (below 1 %):\n" + text;
}

constexpr const char* cycles_help =
    R"(Usage: pcl_bayesian_icp_evaluate cycles GRAPH.g2o [options]

Are the covariances of a pose graph right? Needs no true poses. Around each
cycle of edges the product of the poses should be the identity, within the
sum of the covariances. The normalised squared error of closures (NEES) is
then 1 per degree of freedom on average, and 50 % and 95 % of the closures
are in their regions. Larger errors mean that covariances are too small, or
that an edge is wrong. Edges of the same scan share its noise, and all edges
share the systematic errors of the sensor: --scan-share and --common-share
state these parts of their variance. Directions in which a closure is less
certain than 3 m or 3 rad do not count: no cloud determines them.

Make the graph with pcl_bayesian_icp_track --span 3. Cycles of edges that
contain a prior close too well.

Errors that all edges share nearly cancel: if every registration shortens the
motion in the same proportion, every cycle still closes.

The table goes to standard output; each cycle is a row of a CSV file. Below
the table, one chi-square test combines all cycles and takes their common
edges into account. If all covariances are right, it fails for one graph in a
thousand.
Exit codes: 0 success, 1 that test has failed, or there is no cycle to test,
2 usage, 3 a file cannot be read or written.
)";

po::typed_value<double>*
share(double& part)
{
  const auto option = po::value<double>()->default_value(part, io::textOf(part, 3));
  return option->notifier([&part](double value) {
    if (!(value >= 0.0 && value < 1.0))
      io::refuseValue(io::textOf(value), "from 0 to below 1");
    part = value;
  });
}

} // namespace

int
runCyclesCommand(int argc, const char* const* argv)
{
  CyclesOptions options;
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("max-length", integer(options.max_length, 3, 100), "largest number of edges of a cycle")
    ("scan-share", share(options.shared.scan),
     "part of the variance of an edge that is the noise of each of its two scans, which "
     "moves edges to the scan the other way than edges from it")
    ("common-share", share(options.shared.common),
     "part of the variance that all edges have in common; together with twice the "
     "--scan-share below 1. Both are 0 for edges that are independent");
  // clang-format on
  addResultOptions(options.result, description, "CSV file of the closures");
  const auto given = readOptions(argc, argv, description, cycles_help, "graph");
  const std::vector<std::string> files = io::optionTexts(given, "graph");
  if (files.size() != 1)
    throw io::UsageError("a graph is needed: GRAPH.g2o");
  if (io::isSameFile(files[0], options.result.file))
    throw io::UsageError("--output: " + io::inQuotes(options.result.file) +
                         " is the graph");
  constexpr double rounding = 1e-6;
  if (!(options.shared.own() > rounding))
    throw io::UsageError("twice --scan-share and --common-share: together below 1");
  std::vector<GraphEdge> edges = app::readGraph(files[0]);
  for (GraphEdge& edge : edges)
    edge.shared = options.shared;
  const std::vector<ClosedCycle> cycles =
      app::closedCycles(edges, static_cast<std::size_t>(options.max_length));
  const std::string csv =
      std::filesystem::path(options.result.file).filename().string();
  io::OutputFolder folder(io::folderOf(options.result.file));
  if (cycles.empty())
    folder.leaveOut(csv);
  else
    folder.add(csv, csvOf(cycles));
  folder.commit();
  if (cycles.empty()) {
    io::print(files[0] + " has no cycle of at most " + io::textOf(options.max_length) +
              " edges that the clouds have seen, so nothing tells whether its "
              "covariances are right. A chain of scans has none: make the graph with "
              "pcl_bayesian_icp_track --span 3, or see --max-length.\n");
    return 1;
  }
  const app::JointClosure joint = app::jointClosureOf(edges, cycles);
  io::print(tableOf(cycles) + jointText(joint) + failuresText(cycles) +
            suspectsText(edges, cycles));
  const int report_code = options.result.report();
  return joint.probability >= min_chance ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
