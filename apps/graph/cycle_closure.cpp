#include "graph/cycle_closure.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <deque>
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

/** The shortest way from the target of edge \p direct to its source without that edge;
 * empty if there is none of at most \p max_edges. */
std::vector<std::size_t>
shortestPath(const std::vector<GraphEdge>& edges,
             const Neighbourhood& at,
             std::size_t direct,
             std::size_t max_edges)
{
  /** Of the shortest way to a vertex: its last edge, and the number of its edges. */
  struct Arrival {
    std::size_t last = 0;
    std::size_t length = 0;
  };
  const int begin = edges[direct].target, end = edges[direct].source;
  std::map<int, Arrival> ways{{begin, {}}};
  std::deque<int> next{begin};
  while (!next.empty() && ways.count(end) == 0) {
    const int vertex = next.front();
    next.pop_front();
    const std::size_t length = ways[vertex].length;
    if (length == max_edges)
      continue;
    for (const std::size_t k : at.at(vertex)) {
      const int other = edges[k].otherEnd(vertex);
      if (k != direct && ways.emplace(other, Arrival{k, length + 1}).second)
        next.push_back(other);
    }
  }
  std::vector<std::size_t> path;
  if (ways.count(end) > 0)
    for (int vertex = end; vertex != begin;
         vertex = edges[path.back()].otherEnd(vertex))
      path.push_back(ways[vertex].last);
  std::reverse(path.begin(), path.end());
  return path;
}

/** An edge as it is gone along: from one of its vertices to the other. */
struct Step {
  int end;
  /** The end in the frame of the vertex before. */
  Eigen::Matrix4d T;
  /** Of the edge's error, which is on the right of T_target_source, to the right of T.
   */
  Matrix6d carry;
};

Step
stepFrom(int begin, const GraphEdge& edge)
{
  const Eigen::Matrix4d& T = edge.T_target_source;
  if (edge.target == begin)
    return {edge.source, T, Matrix6d::Identity()};
  // (T exp(xi))^-1 = T^-1 exp(-Ad(T) xi)
  return {edge.target, T.inverse(), -adjointOf(T)};
}

std::vector<Step>
stepsAlong(const std::vector<GraphEdge>& edges,
           int begin,
           const std::vector<std::size_t>& path)
{
  std::vector<Step> steps;
  for (const std::size_t k : path)
    steps.push_back(stepFrom(steps.empty() ? begin : steps.back().end, edges[k]));
  return steps;
}

/** \param[in] carry of twists at the edge's source to the frame of the errors */
void
addError(std::size_t k, const GraphEdge& edge, const Matrix6d& carry, ErrorTerms& terms)
{
  const Matrix6d root = carry * squareRootOf(edge.covariance);
  const auto add = [&terms](const Noise& noise, const Matrix6d& factor) {
    terms.try_emplace(noise, Matrix6d::Zero()).first->second += factor;
  };
  add({NoiseOf::Edge, static_cast<long>(k)}, std::sqrt(edge.shared.own()) * root);
  const double of_scan = std::sqrt(edge.shared.scan);
  add({NoiseOf::Scan, edge.source}, of_scan * root);
  add({NoiseOf::Scan, edge.target},
      -of_scan * root * noiseToSource(edge.T_target_source));
  const CommonFactors of_all =
      commonFactors(root, edge.T_target_source, edge.shared.common);
  for (int column = 0; column < 6; ++column)
    add({NoiseOf::Common, column}, of_all.middleCols<6>(6 * column));
}

} // namespace

std::vector<std::size_t>
Cycle::members() const
{
  std::vector<std::size_t> members = path;
  members.push_back(direct);
  std::sort(members.begin(), members.end());
  return members;
}

std::vector<Cycle>
cyclesOf(const std::vector<GraphEdge>& edges, std::size_t max_length)
{
  const Neighbourhood at = neighbourhoodOf(edges);
  std::set<std::vector<std::size_t>> known; // by their members
  std::vector<Cycle> cycles;
  for (std::size_t direct = edges.size(); direct-- > 0;) {
    const Cycle cycle{direct, shortestPath(edges, at, direct, max_length - 1)};
    if (!cycle.path.empty() && known.insert(cycle.members()).second)
      cycles.push_back(cycle);
  }
  return {cycles.rbegin(), cycles.rend()};
}

void
Way::append(const GraphEdge& edge)
{
  const Step step = stepFrom(end, edge);
  const Matrix6d carry = adjointOf(step.T.inverse());
  const Matrix6d of_step = step.carry * edge.covariance * step.carry.transpose();
  const Matrix6d root = step.carry * squareRootOf(edge.covariance);
  common =
      (carry * common + commonFactors(root, edge.T_target_source, edge.shared.common))
          .eval();
  own = (carry * own * carry.transpose() + (1.0 - edge.shared.common) * of_step).eval();
  T_begin_end = T_begin_end * step.T;
  end = step.end;
}

Matrix6d
Way::covariance() const
{
  return own + common * common.transpose();
}

Way
wayAlong(const std::vector<GraphEdge>& edges,
         int begin,
         const std::vector<std::size_t>& path)
{
  Way way{begin};
  for (const std::size_t k : path)
    way.append(edges[k]);
  return way;
}

ErrorTerms
errorTermsOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  const GraphEdge& direct = edges[cycle.direct];
  ErrorTerms terms;
  addError(cycle.direct, direct, Matrix6d::Identity(), terms);
  const std::vector<Step> steps = stepsAlong(edges, direct.target, cycle.path);
  Eigen::Matrix4d rest = Eigen::Matrix4d::Identity();
  for (std::size_t k = steps.size(); k-- > 0;) {
    // The closure's error is that of the direct edge less those of the path.
    const Matrix6d carry = -adjointOf(rest.inverse()) * steps[k].carry;
    addError(cycle.path[k], edges[cycle.path[k]], carry, terms);
    rest = steps[k].T * rest;
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

double
chanceOf(double squared_error, int num_degrees)
{
  return num_degrees == 0 ? 1.0
                          : boost::math::cdf(boost::math::complement(
                                boost::math::chi_squared(num_degrees), squared_error));
}

Closure
closureOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  const GraphEdge& direct = edges[cycle.direct];
  Eigen::Matrix4d way = Eigen::Matrix4d::Identity();
  for (const Step& step : stepsAlong(edges, direct.target, cycle.path))
    way = way * step.T;
  const Matrix6d S = covarianceOf(errorTermsOf(edges, cycle));
  Closure closure;
  closure.error = logSE3(direct.T_target_source.inverse() * way);
  closure.squared_error = closure.error.dot(S.ldlt().solve(closure.error));
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(S, Eigen::EigenvaluesOnly);
  closure.num_degrees = static_cast<int>(
      (solver.eigenvalues().array() < max_deviation * max_deviation).count());
  closure.probability = chanceOf(closure.squared_error, closure.num_degrees);
  return closure;
}

} // namespace bayesian_icp::app
