#include "cycles/cycles_command.h"

#include "graph/cycle_closure.h"
#include "io/coordinates.h"
#include "io/folders.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "study/csv_fields.h"
#include "study/formatted_text.h"
#include "study/option_values.h"
#include "study/report_program.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

using app::Closure;
using app::Cycle;
using app::GraphEdge;

namespace {

/** Probability below which a cycle is said not to close, and below which the errors of
 * all together are said not to be chance. */
constexpr double min_probability = 0.01, min_chance = 0.001;
constexpr std::size_t max_lines = 20;

struct CyclesOptions {
  int max_length = 4;
  std::string result_file = "results/cycles.csv";
  bool has_report = false;
};

/** A cycle that says something, and how it closes. */
struct ClosedCycle {
  std::string vertices;
  Cycle cycle;
  Closure closure;

  std::size_t
  length() const
  {
    return cycle.path.size() + 1;
  }
};

/** "0-1-2": from the direct edge's target along the path. */
std::string
verticesOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  int vertex = edges[cycle.direct].target;
  std::string text = io::textOf(vertex);
  for (const std::size_t k : cycle.path) {
    vertex = vertex == edges[k].target ? edges[k].source : edges[k].target;
    text += '-' + io::textOf(vertex);
  }
  return text;
}

std::vector<ClosedCycle>
closedCycles(const std::vector<GraphEdge>& edges, int max_length)
{
  std::vector<ClosedCycle> closed;
  for (const Cycle& cycle : cyclesOf(edges, static_cast<std::size_t>(max_length))) {
    const Closure closure = closureOf(edges, cycle);
    if (closure.num_degrees > 0)
      closed.push_back({verticesOf(edges, cycle), cycle, closure});
  }
  return closed;
}

std::string
csvOf(const std::vector<ClosedCycle>& cycles)
{
  CsvRow header;
  for (const std::string title :
       {"vertices", "length", "squared_error", "num_degrees", "probability"})
    header.add(title);
  for (const std::string name : app::coordinate_names)
    header.add("error_" + name);
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

/** One line of the table, of cycles of one length or of all. */
std::string
tableLine(const std::string& name, const std::vector<const ClosedCycle*>& cycles)
{
  double squared_error = 0.0, num_degrees = 0.0, num_in_half = 0.0, num_in_95 = 0.0;
  for (const ClosedCycle* closed : cycles) {
    squared_error += closed->closure.squared_error;
    num_degrees += closed->closure.num_degrees;
    num_in_half += closed->closure.probability > 0.5 ? 1.0 : 0.0;
    num_in_95 += closed->closure.probability > 0.05 ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(cycles.size());
  return format("%-8s %7zu %9.2f %13.2f %6.2f %6.2f\n",
                name.c_str(),
                cycles.size(),
                num_degrees / count,
                squared_error / num_degrees,
                num_in_half / count,
                num_in_95 / count);
}

std::string
tableOf(const std::vector<ClosedCycle>& cycles)
{
  std::map<std::size_t, std::vector<const ClosedCycle*>> of_length;
  std::vector<const ClosedCycle*> all;
  for (const ClosedCycle& closed : cycles) {
    of_length[closed.length()].push_back(&closed);
    all.push_back(&closed);
  }
  std::string text = "length    cycles  degrees  NEES/degree   50 %   95 %\n";
  for (const auto& [length, members] : of_length)
    text += tableLine(io::textOf(length), members);
  return text + tableLine("all", all);
}

/** Edges all of whose cycles fail to close, if they are in more than one. */
std::string
suspectsText(const std::vector<GraphEdge>& edges,
             const std::vector<ClosedCycle>& cycles)
{
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> counts; // failed, all
  for (const ClosedCycle& closed : cycles) {
    std::vector<std::size_t> members = closed.cycle.path;
    members.push_back(closed.cycle.direct);
    for (const std::size_t k : members) {
      counts[k].first += closed.closure.probability < min_probability ? 1 : 0;
      ++counts[k].second;
    }
  }
  std::string text;
  for (const auto& [k, count] : counts)
    if (count.first == count.second && count.second > 1)
      text += "  " + io::textOf(edges[k].target) + '-' + io::textOf(edges[k].source) +
              ": all " + io::textOf(count.second) + " cycles\n";
  return text.empty() ? text : "Edges none of whose cycles closes:\n" + text;
}

std::string
failuresText(std::vector<ClosedCycle> cycles)
{
  const auto closes = [](const ClosedCycle& closed) {
    return closed.closure.probability >= min_probability;
  };
  cycles.erase(std::remove_if(cycles.begin(), cycles.end(), closes), cycles.end());
  std::sort(
      cycles.begin(), cycles.end(), [](const ClosedCycle& a, const ClosedCycle& b) {
        return a.closure.probability < b.closure.probability;
      });
  std::string text;
  for (std::size_t k = 0; k < std::min(cycles.size(), max_lines); ++k) {
    const Closure& closure = cycles[k].closure;
    text += "  " + cycles[k].vertices +
            format(": %.3g m, %.3g rad; NEES %.3g of %d degrees, probability %.2g\n",
                   closure.error.head<3>().norm(),
                   closure.error.tail<3>().norm(),
                   closure.squared_error,
                   closure.num_degrees,
                   closure.probability);
  }
  if (cycles.size() > max_lines)
    text += "  and " + io::textOf(cycles.size() - max_lines) + " more\n";
  return text.empty() ? text : "Cycles that do not close (below 1 %):\n" + text;
}

/** Whether chance makes squared errors that are together as large, if cycles that have
 * edges in common are counted as independent. */
bool
areConsistent(const std::vector<ClosedCycle>& cycles)
{
  double squared_error = 0.0, num_degrees = 0.0;
  for (const ClosedCycle& closed : cycles) {
    squared_error += closed.closure.squared_error;
    num_degrees += closed.closure.num_degrees;
  }
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(num_degrees),
                                                  squared_error)) >= min_chance;
}

std::string
helpText(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_evaluate cycles GRAPH.g2o [options]

Are the covariances of a pose graph right? Needs no true poses. Around each
cycle of edges the product of the poses should be the identity, within the
sum of the covariances. The normalised squared error of closures (NEES) is
then 1 per degree of freedom on average, and 50 % and 95 % of the closures
are in their regions. Larger errors mean that covariances are too small, or
that an edge is wrong. Directions in which a closure is less certain than
3 m or 3 rad are not counted: no cloud has seen them.

Make the graph with pcl_bayesian_icp_track --span 3; edges that contain a
prior close too well.

It cannot see errors that all edges share: if each registration is drawn
towards no motion in the same proportion, every cycle still closes. Edges
with a scan in common are correlated, which makes closures better or worse
than the sum of the covariances says.

A table goes to the standard output; every cycle is a row of a CSV file.
Exit codes: 0 good, 1 the errors of all cycles together are larger than chance
allows (0.1 %), 2 usage, 3 cannot read or write a file.

)" << options;
  return help.str();
}

} // namespace

int
runCyclesCommand(int argc, const char* const* argv)
{
  CyclesOptions options;
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("max-length", integer(options.max_length, 3, 100), "most edges of a cycle")
    ("output", outputName("file", options.result_file), "CSV file of the closures")
    ("report", io::flag(options.has_report),
     "also make a report, with figures, of all results in that folder")
    ("help", "show this text");
  // clang-format on
  const po::variables_map given =
      io::splitCommandLine(argc, argv, description, "graph");
  if (io::printHelpOrVersion(
          given, "", [&description] { return helpText(description); }))
    return 0;
  io::takeOptions(given, description);
  const std::vector<std::string> files = io::optionTexts(given, "graph");
  if (files.size() != 1)
    throw io::UsageError("a graph is needed: GRAPH.g2o");
  const std::vector<GraphEdge> edges = app::readGraph(files[0]);
  const std::vector<ClosedCycle> cycles = closedCycles(edges, options.max_length);
  if (cycles.empty())
    throw io::FileError(files[0],
                        "has no cycle of at most " + io::textOf(options.max_length) +
                            " edges that the clouds have seen");
  io::OutputFolder folder(io::folderOf(options.result_file));
  folder.add(std::filesystem::path(options.result_file).filename().string(),
             [&](std::ostream& stream) { stream << csvOf(cycles); });
  folder.commit();
  io::print(tableOf(cycles) + failuresText(cycles) + suspectsText(edges, cycles));
  const int report_code =
      options.has_report ? makeReport(io::folderOf(options.result_file)) : 0;
  return areConsistent(cycles) ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
