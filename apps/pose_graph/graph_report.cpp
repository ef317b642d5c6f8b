#include "pose_graph/graph_report.h"

#include "graph/closed_cycles.h"
#include "io/coordinates.h"
#include "report/path_charts.h"
#include "report/section.h"

#include <array>

namespace bayesian_icp::app {

namespace {

constexpr std::size_t max_rows = 50;
constexpr int num_digits = 3;

std::string
shortText(double value)
{
  return io::textOf(value, num_digits);
}

std::string
shortTableHtml(const html::Table& table)
{
  return html::limitedTableHtml(table, max_rows, "more.");
}

std::string
verdictHtml(const ScanGraph& graph, std::size_t num_contradictions)
{
  std::size_t num_complaints = 0, num_refused = 0;
  std::array<std::size_t, 4> num_taken{}; // by EdgeKind
  for (const ScanEdge& edge : graph.registrations) {
    if (edge.is_in_graph)
      ++num_taken[static_cast<std::size_t>(edge.kind)];
    if (edge.kind == EdgeKind::Found) // a refused one is no complaint
      num_refused += edge.is_in_graph ? 0 : 1;
    else
      num_complaints += edge.complaint.empty() ? 0 : 1;
  }
  const bool is_good = num_contradictions == 0 && num_complaints == 0;
  std::string sentence = "Edges in the graph";
  for (std::size_t k = 0; k < num_taken.size(); ++k)
    sentence += (k == 0 ? ": " : ", ") +
                std::string(toString(static_cast<EdgeKind>(k))) + ' ' +
                io::textOf(num_taken[k]);
  sentence += ". Candidates for loops that were refused: " + io::textOf(num_refused) +
              ". Other registrations that are not ok: " + io::textOf(num_complaints) +
              ". Edges that contradict the others: " + io::textOf(num_contradictions) +
              '.';
  const std::string unmeasured =
      unmeasuredText(graph.numUnmeasured(), graph.chain.size() - 1);
  if (!unmeasured.empty())
    sentence += " Of the chain, " + unmeasured + '.';
  const bool is_measured = unmeasured.empty();
  return html::boxHtml(is_good && is_measured ? html::Tone::Good : html::Tone::Caution,
                       is_good && is_measured ? "All edges agree"
                       : is_good ? "All edges agree, but not every motion is measured"
                       : num_contradictions > 0
                           ? "Edges contradict each other"
                           : "Not every registration has status ok",
                       html::paragraphHtml(sentence));
}

std::string
loopsHtml(const ScanGraph& graph)
{
  html::Table table;
  table.caption = "Loops, and how they close with the chain before the optimization";
  table.header = {"loop",
                  "error [m]",
                  "error [degrees]",
                  "squared error",
                  "degrees of freedom",
                  "probability",
                  "in the graph",
                  "complaint"};
  table.first_column_of_words = 6;
  for (const ScanEdge& edge : graph.registrations) {
    if (!edge.isLoop())
      continue;
    std::vector<std::string> row = {nameOf(edge.edge), "", "", "", "", ""};
    if (edge.closure) {
      const Closure& closure = *edge.closure;
      row = {nameOf(edge.edge),
             shortText(closure.error.head<3>().norm()),
             shortText(degrees_per_radian * closure.error.tail<3>().norm()),
             io::fixedTextOf(closure.squared_error, 1),
             io::textOf(closure.num_degrees),
             shortText(closure.probability)};
    }
    row.emplace_back(edge.is_in_graph ? "yes" : "no");
    row.push_back(edge.complaint);
    table.rows.push_back(row);
  }
  return shortTableHtml(table);
}

std::string
complaintsHtml(const ScanGraph& graph)
{
  html::Table table;
  table.caption = "Registrations that are not ok";
  table.header = {"edge", "kind", "in the graph", "complaint"};
  table.first_column_of_words = 1;
  for (const ScanEdge& edge : graph.registrations)
    if (!edge.isLoop() && !edge.complaint.empty())
      table.rows.push_back({nameOf(edge.edge),
                            toString(edge.kind),
                            edge.is_in_graph ? "yes" : "no",
                            edge.complaint});
  return shortTableHtml(table);
}

std::string
cyclesHtml(const std::vector<ClosedCycle>& cycles)
{
  html::Table table;
  table.caption = "Cycles of edges, as they are registered";
  table.header = {"edges",
                  "cycles",
                  "degrees of freedom",
                  "squared error per degree",
                  "in the 50 % region [%]",
                  "in the 95 % region [%]"};
  for (const CycleStatistics& line : statisticsOf(cycles))
    table.rows.push_back({line.name,
                          io::textOf(line.num_cycles),
                          io::fixedTextOf(line.num_degrees, 1),
                          io::fixedTextOf(line.nees_per_degree, 2),
                          io::fixedTextOf(100.0 * line.share_in_half, 0),
                          io::fixedTextOf(100.0 * line.share_in_95, 0)});
  html::Table open;
  open.caption = "Cycles that do not close (probability below 1 %)";
  open.header = {
      "scans", "error [m]", "error [degrees]", "squared error", "probability"};
  for (const ClosedCycle& cycle : openCycles(cycles))
    open.rows.push_back(
        {cycle.vertices,
         shortText(cycle.closure.error.head<3>().norm()),
         shortText(degrees_per_radian * cycle.closure.error.tail<3>().norm()),
         io::fixedTextOf(cycle.closure.squared_error, 1),
         shortText(cycle.closure.probability)});
  return shortTableHtml(table) + shortTableHtml(open);
}

std::string
contradictionsHtml(const std::vector<ScanEdge>& edges,
                   const OptimizedPoses& optimum,
                   const std::vector<Disagreement>& disagreements)
{
  html::Table table;
  table.caption = "Edges that contradict the others: squared error above the 99.9 % "
                  "quantile, or none of their cycles closes";
  table.header = {"edge",
                  "from the optimized poses [m]",
                  "[degrees]",
                  "squared error",
                  "cycles of which none closes",
                  "kind"};
  table.first_column_of_words = 5;
  for (const Disagreement& found : disagreements) {
    const GraphEdge& edge = edges[found.edge].edge;
    const Vector6d twist = twistFrom(edge, optimum.poses);
    table.rows.push_back({nameOf(edge),
                          shortText(twist.head<3>().norm()),
                          shortText(degrees_per_radian * twist.tail<3>().norm()),
                          io::fixedTextOf(found.squared_error, 1),
                          io::textOf(found.num_open_cycles),
                          toString(edges[found.edge].kind)});
  }
  return shortTableHtml(table);
}

} // namespace

std::string
graphReportHtml(const ScanGraph& graph,
                const OptimizedPoses& optimum,
                const std::vector<ClosedCycle>& cycles,
                const std::string& command)
{
  const std::vector<ScanEdge> edges = graph.taken();
  const std::vector<Disagreement> disagreements = disagreementsOf(cycles, optimum);
  PathData path{optimum.poses, graph.chain, {}};
  for (const ScanEdge& edge : edges)
    if (edge.isLoop())
      path.loops.emplace_back(edge.edge.target, edge.edge.source);
  std::vector<double> numbers;
  for (std::size_t k = 0; k < path.poses.size(); ++k)
    numbers.push_back(static_cast<double>(k));

  std::vector<std::pair<std::string, std::string>> colours = {
      {path_colour, "optimized poses"},
      {ellipse_colour, "their 95 % regions"},
      {before_colour, "the chain of scans alone"}};
  if (!path.loops.empty())
    colours.emplace_back(loop_colour, "loops");
  const Section trajectory = {"trajectory",
                              "Where was the sensor?",
                              html::legendHtml(colours),
                              {pathChart(path)},
                              loopsHtml(graph) + complaintsHtml(graph)};
  const Section uncertainty = {
      "uncertainty",
      "How certain is it?",
      html::paragraphHtml(
          "Registrations of the same scan share the noise of its points, and "
          "registrations along the same motion share the error that the sensor makes "
          "in each scan. Other errors are treated as independent.") +
          html::legendHtml({{path_colour, "optimized poses"},
                            {before_colour, "the chain of scans alone"}}),
      deviationCharts(numbers, "scan", path)};
  const Section agreement = {
      "agreement",
      "Do the edges agree?",
      cycles.empty()
          ? html::paragraphHtml("There is no cycle, so nothing tests the edges. --span "
                                "and --loops add cycles.")
          : html::paragraphHtml(
                "The product of the poses around a cycle should be the identity, "
                "within the sum of the covariances. The squared error per degree of "
                "freedom is 1 on average if the covariances are right; larger ones "
                "mean that they are too small, or that an edge is wrong.") +
                cyclesHtml(cycles),
      {},
      contradictionsHtml(edges, optimum, disagreements)};
  const Section repeat = {"repeat", "To repeat the run", commandHtml(command)};
  return html::pageHtml("Pose graph of " + io::textOf(optimum.poses.size()) + " scans",
                        verdictHtml(graph, disagreements.size()) +
                            sectionsHtml({trajectory, uncertainty, agreement, repeat}));
}

} // namespace bayesian_icp::app
