#include "pose_graph/scan_graph.h"

#include "io/numbers.h"

#include <bayesian_icp/measurement.h>

#include <Eigen/LU>

namespace bayesian_icp::app {

namespace {

/** Source in target, as edges are named. */
std::string
nameOf(int target, int source)
{
  return io::textOf(target) + '-' + io::textOf(source);
}

/** The prior of a run. */
Prior
priorOf(const Run& run)
{
  return bayesian_icp::priorOf(run.settings.options,
                               poseOf(run.settings.guess),
                               run.source.points.cast<double>());
}

} // namespace

ScanGraph::ScanGraph(const GraphRequest& request,
                     const std::function<void(bool, const std::string&)>& tell)
: request_(request)
, tell_(tell)
{}

BatchPair
ScanGraph::pairOf(int target, int source) const
{
  BatchPair pair;
  pair.name = nameOf(target, source);
  pair.target_file = request_.scans.at(static_cast<std::size_t>(target));
  pair.source_file = request_.scans.at(static_cast<std::size_t>(source));
  pair.settings = request_.settings;
  return pair;
}

std::optional<PoseEstimate>
ScanGraph::edgeOf(const BatchResult& result, bool is_loop)
{
  const std::string what = "edge " + result.pair.name + ": ";
  std::optional<PoseEstimate> edge;
  std::string complaint = result.message;
  if (result.run != nullptr) {
    const PoseEstimate posterior(result.run->result.summary);
    edge = is_loop ? withoutPrior(posterior, priorOf(*result.run)).estimate : posterior;
    complaint = complaintAboutExport(*edge, true);
  }
  const bool is_ok = complaint.empty() && result.status == toString(Status::Ok);
  num_not_ok_ += is_ok ? 0 : 1;
  if (is_ok)
    tell_(true, what + "ok (" + io::fixedTextOf(result.seconds, 1) + " s)");
  else if (complaint.empty())
    tell_(false, what + result.status + ": " + result.message);
  if (complaint.empty())
    return edge;
  if (is_loop || result.run == nullptr || !request_.has_weak_edges) {
    tell_(false, what + "MISSING, " + result.status + ": " + complaint);
    return std::nullopt;
  }
  tell_(false, what + "the prior only, " + result.status + ": " + complaint);
  return estimateOf(priorOf(*result.run));
}

void
ScanGraph::registerPairs(const std::vector<std::pair<int, int>>& indices,
                         bool are_loops)
{
  std::vector<BatchPair> pairs;
  for (const auto& [target, source] : indices) {
    pairs.push_back(pairOf(target, source));
    if (are_loops) {
      Settings& settings = pairs.back().settings;
      settings.guess = poses_.at(static_cast<std::size_t>(target)).inverse() *
                       poses_.at(static_cast<std::size_t>(source));
      settings.options.prior.mean = PriorOptions().mean;
    }
  }
  const std::size_t first = edges_.size();
  edges_.resize(first + pairs.size());
  runBatch(pairs,
           {request_.settings.options.chains.num_threads, ""},
           [&](const BatchResult& result) {
             const auto position =
                 static_cast<std::size_t>(&result.pair - pairs.data());
             edges_[first + position] = edgeOf(result, are_loops);
           });
}

void
ScanGraph::chainPoses()
{
  poses_.assign(1, Eigen::Matrix4d::Identity());
  const Vector6d& prior_mean = request_.settings.options.prior.mean;
  const Eigen::Matrix4d expected =
      prior_mean.allFinite() ? matrixOf(prior_mean) : request_.settings.guess;
  for (const auto& edge : edges_)
    poses_.push_back(poses_.back() * (edge ? matrixOf(edge->mean) : expected));
}

void
ScanGraph::registerScans()
{
  std::vector<std::pair<int, int>> chain;
  for (int k = 0; k + 1 < static_cast<int>(request_.scans.size()); ++k)
    chain.emplace_back(k, k + 1);
  registerPairs(chain, false);
  chainPoses();
  registerPairs(request_.loops, true);
}

std::string
ScanGraph::g2oText() const
{
  std::string text;
  for (std::size_t k = 0; k < poses_.size(); ++k)
    text += g2oVertex(poses_[k], static_cast<int>(k));
  text += "FIX 0\n";
  const std::size_t chain_length = poses_.size() - 1;
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    if (!edges_[k])
      continue;
    ExportOptions options;
    options.target_vertex =
        k < chain_length ? static_cast<int>(k) : request_.loops[k - chain_length].first;
    options.source_vertex = k < chain_length ? static_cast<int>(k) + 1
                                             : request_.loops[k - chain_length].second;
    text += g2oEdge(*edges_[k], options);
  }
  return text;
}

} // namespace bayesian_icp::app
