#include "pose_graph/scan_graph.h"

#include "graph/sensor_plane.h"
#include "graph/trajectory_files.h"
#include "io/coordinates.h"
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

/** Along the chain, the step k being from scan k to k + 1. */
std::vector<std::size_t>
pathBetween(int target, int source)
{
  std::vector<std::size_t> path;
  for (int k = std::min(target, source); k < std::max(target, source); ++k)
    path.push_back(static_cast<std::size_t>(k));
  if (target > source)
    std::reverse(path.begin(), path.end());
  return path;
}

/** "0.0312 m and 1.2 degrees" */
std::string
sizeOf(const Vector6d& twist)
{
  constexpr int num_digits = 3;
  return io::textOf(twist.head<3>().norm(), num_digits) + " m and " +
         io::textOf(degrees_per_radian * twist.tail<3>().norm(), num_digits) +
         " degrees";
}

/** Makes a ScanGraph. */
class Registrar {
public:
  Registrar(const GraphRequest& request,
            const std::function<void(bool, const std::string&)>& tell)
  : request_(request)
  , tell_(tell)
  , wide_variance_(inPlane(PriorOptions().variance))
  {
    Vector6d& variance = request_.settings.options.prior.variance;
    variance = inPlane(variance);
  }

  ScanGraph
  run()
  {
    std::vector<ScanEdge> chain;
    for (int k = 0; k + 1 < static_cast<int>(request_.scans.size()); ++k)
      chain.push_back(unregistered(EdgeKind::Chain, k, k + 1));
    registerEdges(chain);
    chainPoses();
    registerEdges(moreEdges());
    return graph_;
  }

private:
  /** Variances of a prior that keeps the sensor in its plane. */
  Vector6d
  inPlane(const Vector6d& variance) const
  {
    if (!request_.plane_normal || !variance.allFinite())
      return variance;
    return keptInPlane(variance.asDiagonal(), projectionToPlane(request_.plane_normal))
        .diagonal();
  }

  static ScanEdge
  unregistered(EdgeKind kind, int target, int source)
  {
    ScanEdge edge;
    edge.kind = kind;
    edge.edge.target = target;
    edge.edge.source = source;
    return edge;
  }

  /** The pair of an edge as it is to be registered. \throws Refusal */
  BatchPair
  pairOf(const ScanEdge& edge) const
  {
    const GraphEdge& scans = edge.edge;
    BatchPair pair;
    pair.name = nameOf(scans);
    pair.target_file = request_.scans.at(static_cast<std::size_t>(scans.target));
    pair.source_file = request_.scans.at(static_cast<std::size_t>(scans.source));
    pair.settings = request_.settings;
    pair.settings.options.chains.num_threads = 0; // runBatch() shares them out
    if (edge.kind != EdgeKind::Chain) {
      const Way way =
          wayAlong(steps_, scans.target, pathBetween(scans.target, scans.source));
      const Matrix6d wide = wide_variance_.asDiagonal();
      pair.settings.guess = way.T_begin_end;
      pair.settings.options.prior =
          priorFrom(statedPoseOf(poseOf(way.T_begin_end), way.covariance() + wide))
              .options;
    }
    return pair;
  }

  void
  registerEdges(std::vector<ScanEdge> edges)
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
             request_.settings.options.chains.num_threads,
             "",
             [&](const BatchResult& result) {
               const auto position =
                   static_cast<std::size_t>(&result.pair - pairs.data());
               ScanEdge& edge = edges[positions[position]];
               take(result, edge);
               report(edge);
             });
    graph_.registrations.insert(graph_.registrations.end(), edges.begin(), edges.end());
  }

  void
  take(const BatchResult& result, ScanEdge& edge) const
  {
    edge.seconds = result.seconds;
    edge.message = result.message;
    const bool is_found = edge.kind == EdgeKind::Found;
    const std::string left_out = is_found                      ? "refused, "
                                 : edge.kind == EdgeKind::Span ? "left out, "
                                                               : "MISSING, ";
    std::string reason = result.status + ": " + result.message;
    if (result.run != nullptr) {
      const Summary& summary = result.run->result.summary;
      const PoseEstimate posterior(summary);
      const PoseMeasurement of_clouds = withoutPrior(posterior, priorOf(*result.run));
      std::string complaint = complaintAboutEdge(summary);
      if (complaint.empty())
        complaint = setEdge(
            edge.kind == EdgeKind::Chain ? posterior : of_clouds.estimate, edge.edge);
      edge.is_in_graph = complaint.empty();
      if (edge.is_in_graph)
        edge.num_unmeasured =
            std::max(0,
                     of_clouds.num_unmeasured -
                         (request_.plane_normal ? num_motions_out_of_plane : 0));
      else
        reason += "; not used: " + complaint;
    }
    if (edge.is_in_graph) {
      if (result.status != toString(Status::Ok)) {
        edge.complaint = reason;
        edge.edge.covariance *= doubt_factor;
      }
      if (edge.isLoop())
        closeLoop(edge);
      if ((is_found || edge.kind == EdgeKind::Span) && !edge.complaint.empty()) {
        edge.is_in_graph = false;
        edge.complaint = left_out + edge.complaint;
      }
      return;
    }
    edge.is_in_graph = edge.kind == EdgeKind::Chain && request_.has_weak_edges &&
                       result.run != nullptr &&
                       setEdge(estimateOf(priorOf(*result.run)), edge.edge).empty();
    edge.edge.shared = independent_noise; // a prior has no noise of a scan
    edge.complaint = (edge.is_in_graph ? "the prior only, " : left_out) + reason;
  }

  /** See whether a loop contradicts the chain. */
  void
  closeLoop(ScanEdge& edge) const
  {
    std::vector<GraphEdge> edges;
    Cycle cycle;
    for (const std::size_t k : pathBetween(edge.edge.target, edge.edge.source)) {
      cycle.path.push_back(edges.size());
      edges.push_back(steps_[k]);
    }
    cycle.direct = edges.size();
    edges.push_back(edge.edge);
    const Closure closure = closureOf(edges, cycle);
    edge.closure = closure;
    if (closure.probability >= min_loop_probability)
      return;
    edge.complaint =
        "contradicts the chain, " + sizeOf(closure.error) + " away: squared error " +
        io::fixedTextOf(closure.squared_error, 1) + " for " +
        io::textOf(closure.num_degrees) + " degrees of freedom, probability " +
        io::textOf(closure.probability, 2);
  }

  void
  report(const ScanEdge& edge) const
  {
    std::string text = edge.complaint;
    if (text.empty())
      text = "ok (" + io::fixedTextOf(edge.seconds, 1) + " s)" +
             (edge.num_unmeasured > 0 ? ", " + edge.message : "");
    if (edge.complaint.empty() && edge.closure)
      text += ", closes with probability " + io::textOf(edge.closure->probability, 2);
    const bool is_found = edge.kind == EdgeKind::Found;
    tell_(edge.complaint.empty() || is_found,
          (is_found ? "loop " : "edge ") + nameOf(edge.edge) + ": " + text);
  }

  void
  chainPoses()
  {
    const PriorOptions& prior = request_.settings.options.prior;
    const PriorOptions usual;
    const Vector6d expected =
        prior.mean.allFinite() ? prior.mean : poseOf(request_.settings.guess);
    const Prior assumed(expected,
                        prior.variance.allFinite() ? prior.variance : usual.variance);
    Way way;
    graph_.chain.assign(1, GaussianPose());
    for (const ScanEdge& edge : graph_.registrations) {
      steps_.push_back(edge.edge);
      if (!edge.is_in_graph) {
        const PoseEstimate estimate = estimateOf(assumed);
        steps_.back().shared = independent_noise;
        steps_.back().T_target_source = matrixOf(estimate.mean);
        steps_.back().covariance = estimate.covariance(CovarianceConvention::RightSE3);
      }
      way.append(steps_.back());
      graph_.chain.push_back({poseOf(way.T_begin_end), way.covariance()});
    }
  }

  /** All that are not of the chain. */
  std::vector<ScanEdge>
  moreEdges() const
  {
    std::vector<ScanEdge> edges;
    std::set<std::pair<int, int>> known;
    const auto add = [&](EdgeKind kind, int target, int source) {
      if (known.insert(std::minmax(target, source)).second)
        edges.push_back(unregistered(kind, target, source));
    };
    for (const auto& [target, source] : request_.loops)
      add(EdgeKind::Named, target, source);
    for (int k = 0; k < static_cast<int>(graph_.chain.size()); ++k)
      for (int before = std::max(0, k - request_.span); before + 1 < k; ++before)
        add(EdgeKind::Span, before, k);
    if (request_.loop_radius > 0.0) {
      const auto candidates = loopCandidates(graph_.chain, request_.loop_radius);
      for (const auto& [target, source] : candidates)
        add(EdgeKind::Found, target, source);
      tell_(true,
            io::textOf(candidates.size()) + " candidates for loops, within " +
                io::textOf(request_.loop_radius) + " m of an earlier scan");
    }
    return edges;
  }

  GraphRequest request_;
  const std::function<void(bool, const std::string&)>& tell_;
  /** Of a prior about what the chain says. */
  Vector6d wide_variance_;
  ScanGraph graph_;
  /** From each scan to the next, all of them. */
  std::vector<GraphEdge> steps_;
};

} // namespace

const char*
toString(EdgeKind kind)
{
  static constexpr std::array<const char*, 4> names = {
      "chain", "--span", "--loop", "--loops"};
  return names[static_cast<std::size_t>(kind)];
}

std::string
nameOf(const GraphEdge& edge)
{
  return io::textOf(edge.target) + '-' + io::textOf(edge.source);
}

std::vector<ScanEdge>
ScanGraph::taken() const
{
  std::vector<ScanEdge> edges;
  std::copy_if(registrations.begin(),
               registrations.end(),
               std::back_inserter(edges),
               [](const ScanEdge& edge) { return edge.is_in_graph; });
  return edges;
}

std::size_t
ScanGraph::numUnmeasured() const
{
  return static_cast<std::size_t>(std::count_if(
      registrations.begin(), registrations.end(), [](const ScanEdge& edge) {
        return edge.kind == EdgeKind::Chain && edge.num_unmeasured > 0;
      }));
}

ScanGraph
registerScans(const GraphRequest& request,
              const std::function<void(bool, const std::string&)>& tell)
{
  return Registrar(request, tell).run();
}

} // namespace bayesian_icp::app
