#include "pose_graph/scan_graph.h"

#include "graph/loop_candidates.h"
#include "graph/trajectory_files.h"
#include "io/numbers.h"
#include "localization/stated_pose.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/measurement.h>

#include <algorithm>
#include <array>
#include <set>

namespace bayesian_icp::app {

namespace {

/** Probability below which a loop is said to contradict the chain. */
constexpr double min_loop_probability = 0.001;

/** The prior of a run. */
Prior
priorOf(const Run& run)
{
  return bayesian_icp::priorOf(run.settings.options,
                               poseOf(run.settings.guess),
                               run.source.points.cast<double>());
}

/** Put an estimate into an edge. \return why it cannot be one; empty if it is */
std::string
setEdge(const PoseEstimate& estimate, GraphEdge& edge)
{
  std::string complaint = complaintAboutExport(estimate, false);
  if (!complaint.empty())
    return complaint;
  edge.T_target_source = matrixOf(estimate.mean);
  edge.covariance =
      invertibleCovariance(estimate.covariance(CovarianceConvention::RightSE3));
  PoseEstimate invertible =
      estimateOf(estimate.mean, edge.covariance, CovarianceConvention::RightSE3);
  invertible.status = Status::Ok;
  return complaintAboutExport(invertible, true);
}

} // namespace

const char*
toString(EdgeKind kind)
{
  static constexpr std::array<const char*, 4> names = {
      "chain", "--span", "--loop", "--loops"};
  return names[static_cast<std::size_t>(kind)];
}

std::vector<GraphEdge>
edgesOf(const std::vector<ScanEdge>& edges)
{
  std::vector<GraphEdge> plain;
  for (const ScanEdge& edge : edges)
    plain.push_back(edge.edge);
  return plain;
}

std::string
nameOf(const GraphEdge& edge)
{
  return io::textOf(edge.target) + '-' + io::textOf(edge.source);
}

std::string
sizeOf(const Vector6d& twist)
{
  constexpr int num_digits = 3;
  return io::textOf(twist.head<3>().norm(), num_digits) + " m and " +
         io::textOf(degrees * twist.tail<3>().norm(), num_digits) + " degrees";
}

ScanGraph::ScanGraph(const GraphRequest& request,
                     const std::function<void(bool, const std::string&)>& tell)
: request_(request)
, tell_(tell)
{}

BatchPair
ScanGraph::pairOf(const ScanEdge& edge) const
{
  const GraphEdge& scans = edge.edge;
  BatchPair pair;
  pair.name = nameOf(scans);
  pair.target_file = request_.scans.at(static_cast<std::size_t>(scans.target));
  pair.source_file = request_.scans.at(static_cast<std::size_t>(scans.source));
  pair.settings = request_.settings;
  if (edge.kind != EdgeKind::Chain) {
    const GraphEdge way =
        wayAlong(steps_, scans.target, pathBetween(scans.target, scans.source));
    const Matrix6d wide = PriorOptions().variance.asDiagonal();
    double widening = 1.0;
    pair.settings.guess = way.T_target_source;
    pair.settings.options.prior =
        priorFrom(statedPoseOf(poseOf(way.T_target_source), way.covariance + wide),
                  PriorFloor(),
                  widening);
  }
  return pair;
}

void
ScanGraph::closeLoop(ScanEdge& edge) const
{
  std::vector<GraphEdge> edges = steps_;
  edges.push_back(edge.edge);
  const Closure closure = closureOf(
      edges, {steps_.size(), pathBetween(edge.edge.target, edge.edge.source)});
  edge.closure = closure;
  if (closure.probability >= min_loop_probability)
    return;
  edge.complaint = "contradicts the chain, " + sizeOf(closure.error) +
                   " away: squared error " + io::fixedTextOf(closure.squared_error, 1) +
                   " for " + io::textOf(closure.num_degrees) +
                   " degrees of freedom, probability " +
                   io::textOf(closure.probability, 2);
}

void
ScanGraph::take(const BatchResult& result, ScanEdge& edge) const
{
  edge.seconds = result.seconds;
  const bool is_found = edge.kind == EdgeKind::Found;
  const std::string left_out = is_found                      ? "refused, "
                               : edge.kind == EdgeKind::Span ? "left out, "
                                                             : "MISSING, ";
  std::string complaint = result.message;
  if (result.run != nullptr) {
    const PoseEstimate posterior(result.run->result.summary);
    complaint = setEdge(edge.kind == EdgeKind::Chain
                            ? posterior
                            : withoutPrior(posterior, priorOf(*result.run)).estimate,
                        edge.edge);
    edge.is_in_graph = complaint.empty();
  }
  if (edge.is_in_graph) {
    if (result.status != toString(Status::Ok)) {
      edge.complaint = result.status + ": " + result.message;
      edge.edge.covariance *= doubt_factor;
    }
    if (is_found || edge.kind == EdgeKind::Named)
      closeLoop(edge);
    if ((is_found || edge.kind == EdgeKind::Span) && !edge.complaint.empty()) {
      edge.is_in_graph = false;
      edge.complaint = left_out + edge.complaint;
    }
    return;
  }
  const std::string reason = result.status + ": " + complaint;
  edge.is_in_graph = edge.kind == EdgeKind::Chain && request_.has_weak_edges &&
                     result.run != nullptr &&
                     setEdge(estimateOf(priorOf(*result.run)), edge.edge).empty();
  edge.edge.shared = independent_noise; // a prior has no noise of a scan
  edge.complaint = (edge.is_in_graph ? "the prior only, " : left_out) + reason;
}

void
ScanGraph::report(const ScanEdge& edge) const
{
  std::string text = edge.complaint;
  if (text.empty())
    text = "ok (" + io::fixedTextOf(edge.seconds, 1) + " s)";
  if (edge.complaint.empty() && edge.closure)
    text += ", closes with probability " + io::textOf(edge.closure->probability, 2);
  const bool is_found = edge.kind == EdgeKind::Found;
  tell_(edge.complaint.empty() || is_found,
        (is_found ? "loop " : "edge ") + nameOf(edge.edge) + ": " + text);
}

void
ScanGraph::registerEdges(std::vector<ScanEdge> edges)
{
  std::vector<BatchPair> pairs;
  std::vector<std::size_t> positions;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    try {
      pairs.push_back(pairOf(edges[k]));
      positions.push_back(k);
    }
    catch (const Refusal& refusal) {
      edges[k].complaint = std::string("MISSING: ") + refusal.what();
      report(edges[k]);
    }
  }
  runBatch(pairs,
           {request_.settings.options.chains.num_threads, ""},
           [&](const BatchResult& result) {
             const auto position =
                 static_cast<std::size_t>(&result.pair - pairs.data());
             ScanEdge& edge = edges[positions[position]];
             take(result, edge);
             report(edge);
           });
  registrations_.insert(registrations_.end(), edges.begin(), edges.end());
}

void
ScanGraph::chainPoses()
{
  const PriorOptions& prior = request_.settings.options.prior;
  const PriorOptions usual;
  const Vector6d expected =
      prior.mean.allFinite() ? prior.mean : poseOf(request_.settings.guess);
  const Prior assumed(expected,
                      prior.variance.allFinite() ? prior.variance : usual.variance);
  Way way(0);
  chain_.assign(1, GaussianPose());
  for (const ScanEdge& edge : registrations_) {
    steps_.push_back(edge.edge);
    if (!edge.is_in_graph) {
      const PoseEstimate estimate = estimateOf(assumed);
      steps_.back().shared = independent_noise;
      steps_.back().T_target_source = matrixOf(estimate.mean);
      steps_.back().covariance = estimate.covariance(CovarianceConvention::RightSE3);
    }
    way.append(steps_.back());
    const GraphEdge whole = way.edge();
    chain_.push_back({poseOf(whole.T_target_source), whole.covariance});
  }
}

std::vector<std::size_t>
ScanGraph::pathBetween(int target, int source) const
{
  std::vector<std::size_t> path;
  for (int k = std::min(target, source); k < std::max(target, source); ++k)
    path.push_back(static_cast<std::size_t>(k));
  if (target > source)
    std::reverse(path.begin(), path.end());
  return path;
}

std::vector<ScanEdge>
ScanGraph::moreEdges() const
{
  std::vector<ScanEdge> edges;
  std::set<std::pair<int, int>> known;
  const auto add = [&](EdgeKind kind, int target, int source) {
    if (!known.insert(std::minmax(target, source)).second)
      return;
    edges.emplace_back();
    edges.back().kind = kind;
    edges.back().edge.target = target;
    edges.back().edge.source = source;
  };
  for (const auto& [target, source] : request_.loops)
    add(EdgeKind::Named, target, source);
  for (int k = 0; k < static_cast<int>(chain_.size()); ++k)
    for (int before = std::max(0, k - request_.span); before + 1 < k; ++before)
      add(EdgeKind::Span, before, k);
  if (request_.loop_radius > 0.0) {
    const auto candidates = loopCandidates(chain_, request_.loop_radius);
    for (const auto& [target, source] : candidates)
      add(EdgeKind::Found, target, source);
    tell_(true,
          io::textOf(candidates.size()) + " candidates for loops, within " +
              io::textOf(request_.loop_radius) + " m of an earlier scan");
  }
  return edges;
}

void
ScanGraph::registerScans()
{
  std::vector<ScanEdge> chain;
  for (int k = 0; k + 1 < static_cast<int>(request_.scans.size()); ++k) {
    chain.emplace_back();
    chain.back().edge.target = k;
    chain.back().edge.source = k + 1;
  }
  registerEdges(chain);
  chainPoses();
  registerEdges(moreEdges());
}

std::vector<ScanEdge>
ScanGraph::taken() const
{
  std::vector<ScanEdge> edges;
  std::copy_if(registrations_.begin(),
               registrations_.end(),
               std::back_inserter(edges),
               [](const ScanEdge& edge) { return edge.is_in_graph; });
  return edges;
}

} // namespace bayesian_icp::app
