#include "graph/cycle_closure.h"

#include "graph/adjoint.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <set>

namespace bayesian_icp::app {

namespace {

/** Edges at each vertex, by their positions. */
using Neighbourhood = std::map<int, std::vector<std::size_t>>;

Neighbourhood
neighbourhoodOf(const std::vector<GraphEdge>& edges)
{
  Neighbourhood at;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    at[edges[k].target].push_back(k);
    at[edges[k].source].push_back(k);
  }
  return at;
}

int
otherEnd(const GraphEdge& edge, int vertex)
{
  return vertex == edge.target ? edge.source : edge.target;
}

/** The shortest way from the target of edge \p direct to its source without that edge;
 * empty if there is none of at most \p max_edges. */
std::vector<std::size_t>
shortestPath(const std::vector<GraphEdge>& edges,
             const Neighbourhood& at,
             std::size_t direct,
             std::size_t max_edges)
{
  /** The last edge of the way to a vertex, and the number of its edges. */
  struct Way {
    std::size_t last = 0;
    std::size_t length = 0;
  };
  const int begin = edges[direct].target, end = edges[direct].source;
  std::map<int, Way> ways{{begin, {}}};
  std::deque<int> next{begin};
  while (!next.empty() && ways.count(end) == 0) {
    const int vertex = next.front();
    next.pop_front();
    const std::size_t length = ways[vertex].length;
    if (length == max_edges)
      continue;
    for (const std::size_t k : at.at(vertex)) {
      const int other = otherEnd(edges[k], vertex);
      if (k != direct && ways.emplace(other, Way{k, length + 1}).second)
        next.push_back(other);
    }
  }
  std::vector<std::size_t> path;
  if (ways.count(end) > 0)
    for (int vertex = end; vertex != begin;
         vertex = otherEnd(edges[path.back()], vertex))
      path.push_back(ways[vertex].last);
  std::reverse(path.begin(), path.end());
  return path;
}

/** The edge as seen from its source. */
GraphEdge
inverted(const GraphEdge& edge)
{
  // (T exp(xi))^-1 = T^-1 exp(-Ad(T) xi)
  const Eigen::Matrix4d back = edge.T_target_source.inverse();
  const Matrix6d carry = adjointOf(edge.T_target_source);
  return {edge.source, edge.target, back, carry * edge.covariance * carry.transpose()};
}

/** Of the end of a path in the frame of vertex \p begin. */
Eigen::Matrix4d
poseAlong(const std::vector<GraphEdge>& edges,
          int begin,
          const std::vector<std::size_t>& path)
{
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  for (const std::size_t k : path) {
    const GraphEdge& edge = edges[k];
    const bool is_forward = edge.target == begin;
    pose = pose * (is_forward ? edge.T_target_source
                              : Eigen::Matrix4d(edge.T_target_source.inverse()));
    begin = is_forward ? edge.source : edge.target;
  }
  return pose;
}

/** \param[in] carry of twists at the edge's source to the frame of the errors */
void
addError(std::size_t k, const GraphEdge& edge, const Matrix6d& carry, ErrorTerms& terms)
{
  const Matrix6d root = carry * squareRootOf(edge.covariance);
  const auto add = [&terms](const Noise& noise, const Matrix6d& factor) {
    terms.try_emplace(noise, Matrix6d::Zero()).first->second += factor;
  };
  add({Noise::Of::Edge, static_cast<long>(k)}, std::sqrt(edge.shared.own()) * root);
  add({Noise::Of::Source, edge.source}, std::sqrt(edge.shared.source) * root);
  add({Noise::Of::Common, 0}, std::sqrt(edge.shared.common) * root);
}

} // namespace

std::vector<Cycle>
cyclesOf(const std::vector<GraphEdge>& edges, std::size_t max_length)
{
  const Neighbourhood at = neighbourhoodOf(edges);
  std::set<std::set<std::size_t>> known;
  std::vector<Cycle> cycles;
  for (std::size_t direct = edges.size(); direct-- > 0;) {
    const std::vector<std::size_t> path =
        shortestPath(edges, at, direct, max_length - 1);
    std::set<std::size_t> members(path.begin(), path.end());
    members.insert(direct);
    if (!path.empty() && known.insert(members).second)
      cycles.push_back({direct, path});
  }
  return {cycles.rbegin(), cycles.rend()};
}

Way::Way(int begin) : edge_{begin, begin, Eigen::Matrix4d::Identity(), Matrix6d::Zero()}
{}

void
Way::append(const GraphEdge& edge)
{
  const bool is_forward = edge.target == edge_.source;
  const GraphEdge step = is_forward ? edge : inverted(edge);
  const Matrix6d carry = adjointOf(step.T_target_source.inverse());
  const Matrix6d root = squareRootOf(edge.covariance);
  // (T exp(xi))^-1 = T^-1 exp(-Ad(T) xi)
  const Matrix6d of_step =
      is_forward ? root : Matrix6d(-adjointOf(edge.T_target_source) * root);
  common_ = (carry * common_ + std::sqrt(edge.shared.common) * of_step).eval();
  edge_.covariance = (carry * edge_.covariance * carry.transpose() +
                      (1.0 - edge.shared.common) * step.covariance)
                         .eval();
  edge_.T_target_source = (edge_.T_target_source * step.T_target_source).eval();
  edge_.source = step.source;
}

GraphEdge
Way::edge() const
{
  GraphEdge whole = edge_;
  whole.covariance += common_ * common_.transpose();
  return whole;
}

GraphEdge
wayAlong(const std::vector<GraphEdge>& edges,
         int begin,
         const std::vector<std::size_t>& path)
{
  Way way(begin);
  for (const std::size_t k : path)
    way.append(edges[k]);
  return way.edge();
}

ErrorTerms
errorTermsOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  const GraphEdge& direct = edges[cycle.direct];
  ErrorTerms terms;
  addError(cycle.direct, direct, Matrix6d::Identity(), terms);
  GraphEdge rest;
  rest.target = direct.source;
  for (auto k = cycle.path.rbegin(); k != cycle.path.rend(); ++k) {
    const GraphEdge& edge = edges[*k];
    const bool is_forward = edge.source == rest.target;
    const Eigen::Matrix4d T = edge.T_target_source;
    // The closure's error is that of the direct edge less those of the path; backwards,
    // (T exp(xi))^-1 = T^-1 exp(-Ad(T) xi).
    const Matrix6d carry = adjointOf(rest.T_target_source.inverse());
    addError(*k,
             edge,
             is_forward ? Matrix6d(-carry) : Matrix6d(carry * adjointOf(T)),
             terms);
    rest.T_target_source =
        (is_forward ? T : Eigen::Matrix4d(T.inverse())) * rest.T_target_source;
    rest.target = is_forward ? edge.target : edge.source;
  }
  return terms;
}

Matrix6d
covarianceOf(const ErrorTerms& terms)
{
  Matrix6d sum = Matrix6d::Zero();
  for (const auto& [noise, factor] : terms)
    sum += factor * factor.transpose();
  return sum;
}

Closure
closureOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  const GraphEdge& direct = edges[cycle.direct];
  const Eigen::Matrix4d way = poseAlong(edges, direct.target, cycle.path);
  const Matrix6d S = covarianceOf(errorTermsOf(edges, cycle));
  Closure closure;
  closure.error = logSE3(direct.T_target_source.inverse() * way);
  closure.squared_error = closure.error.dot(S.ldlt().solve(closure.error));
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(S, Eigen::EigenvaluesOnly);
  closure.num_degrees = static_cast<int>(
      (solver.eigenvalues().array() < max_deviation * max_deviation).count());
  if (closure.num_degrees > 0)
    closure.probability = boost::math::cdf(boost::math::complement(
        boost::math::chi_squared(closure.num_degrees), closure.squared_error));
  return closure;
}

} // namespace bayesian_icp::app
