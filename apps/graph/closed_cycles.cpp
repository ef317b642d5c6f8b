#include "graph/closed_cycles.h"

#include "io/numbers.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

namespace bayesian_icp::app {

namespace {

std::string
verticesOf(const std::vector<GraphEdge>& edges, const Cycle& cycle)
{
  int vertex = edges[cycle.direct].target;
  std::string text = io::textOf(vertex);
  for (const std::size_t k : cycle.path) {
    vertex = edges[k].otherEnd(vertex);
    text += '-' + io::textOf(vertex);
  }
  return text;
}

/** Cycles none of which is a sum (of edges, modulo 2) of shorter ones. */
std::vector<const ClosedCycle*>
independentOf(const std::vector<ClosedCycle>& cycles)
{
  std::vector<const ClosedCycle*> by_length;
  for (const ClosedCycle& closed : cycles)
    by_length.push_back(&closed);
  std::stable_sort(
      by_length.begin(), by_length.end(), [](const auto* a, const auto* b) {
        return a->length() < b->length();
      });
  std::map<std::size_t, std::vector<std::size_t>> basis; // by the first edge
  std::vector<const ClosedCycle*> independent;
  for (const ClosedCycle* closed : by_length)
    for (std::vector<std::size_t> rest = closed->cycle.members(); !rest.empty();) {
      const auto [found, is_new] = basis.emplace(rest.front(), rest);
      if (is_new) {
        independent.push_back(closed);
        break;
      }
      std::vector<std::size_t> sum;
      std::set_symmetric_difference(rest.begin(),
                                    rest.end(),
                                    found->second.begin(),
                                    found->second.end(),
                                    std::back_inserter(sum));
      rest = std::move(sum);
    }
  return independent;
}

/** Errors along single directions, each of them a row of factors of noises. */
class ErrorRows {
public:
  void
  add(double error, const Vector6d& direction, const ErrorTerms& terms)
  {
    const auto row = static_cast<int>(errors_.size());
    errors_.push_back(error);
    common_.emplace_back(AlongCommon::Zero());
    for (const auto& [noise, factor] : terms) {
      if (noise.first == NoiseOf::Common) {
        common_.back().segment<6>(6 * noise.second) = factor.transpose() * direction;
        continue;
      }
      const int column =
          6 *
          columns_.try_emplace(noise, static_cast<int>(columns_.size())).first->second;
      for (int k = 0; k < 6; ++k)
        factors_.emplace_back(row, column + k, direction.dot(factor.col(k)));
    }
  }

  int
  size() const
  {
    return static_cast<int>(errors_.size());
  }

  /** In units of their covariance. */
  double
  squaredError() const
  {
    Eigen::SparseMatrix<double> factors(size(), 6 * static_cast<int>(columns_.size()));
    factors.setFromTriplets(factors_.begin(), factors_.end());
    const Eigen::SparseMatrix<double> covariance = factors * factors.transpose();
    const Eigen::Map<const Eigen::VectorXd> errors(errors_.data(), size());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(covariance);
    // The common noise would fill the covariance, so it is added by Woodbury's
    // identity.
    Eigen::MatrixXd common(size(), num_common);
    for (int row = 0; row < size(); ++row)
      common.row(row) = common_[static_cast<std::size_t>(row)];
    const Eigen::VectorXd weighted = solver.solve(errors);
    const AlongCommon seen = common.transpose() * weighted;
    Eigen::MatrixXd rest = common.transpose() * solver.solve(common);
    rest.diagonal().array() += 1.0;
    return errors.dot(weighted) - seen.dot(rest.ldlt().solve(seen));
  }

private:
  /** An error along one direction as a sum over what all edges have in common. */
  using AlongCommon = Eigen::Matrix<double, num_common, 1>;

  std::vector<double> errors_;
  std::map<Noise, int> columns_;
  std::vector<Eigen::Triplet<double>> factors_;
  std::vector<AlongCommon> common_;
};

} // namespace

std::vector<ClosedCycle>
closedCycles(const std::vector<GraphEdge>& edges, std::size_t max_length)
{
  std::vector<ClosedCycle> closed;
  for (const Cycle& cycle : cyclesOf(edges, max_length)) {
    const Closure closure = closureOf(edges, cycle);
    if (closure.num_degrees > 0)
      closed.push_back({verticesOf(edges, cycle), cycle, closure});
  }
  return closed;
}

std::vector<CycleStatistics>
statisticsOf(const std::vector<ClosedCycle>& cycles)
{
  constexpr std::size_t all = std::numeric_limits<std::size_t>::max();
  std::map<std::size_t, CycleStatistics> sums; // by length
  for (const ClosedCycle& closed : cycles)
    for (const std::size_t length : {closed.length(), all}) {
      CycleStatistics& sum = sums[length];
      ++sum.num_cycles;
      sum.nees_per_degree += closed.closure.squared_error;
      sum.num_degrees += closed.closure.num_degrees;
      sum.share_in_half += closed.closure.probability > 0.5 ? 1.0 : 0.0;
      sum.share_in_95 += closed.closure.probability > 0.05 ? 1.0 : 0.0;
    }
  std::vector<CycleStatistics> lines;
  for (auto& [length, line] : sums) {
    line.name = length == all ? "all" : io::textOf(length);
    line.nees_per_degree /= line.num_degrees;
    for (double* const mean :
         {&line.num_degrees, &line.share_in_half, &line.share_in_95})
      *mean /= static_cast<double>(line.num_cycles);
    lines.push_back(line);
  }
  return lines;
}

std::vector<ClosedCycle>
openCycles(const std::vector<ClosedCycle>& cycles)
{
  std::vector<ClosedCycle> open;
  std::copy_if(cycles.begin(),
               cycles.end(),
               std::back_inserter(open),
               [](const ClosedCycle& closed) { return !closed.closes(); });
  std::sort(open.begin(), open.end(), [](const ClosedCycle& a, const ClosedCycle& b) {
    return a.closure.probability < b.closure.probability;
  });
  return open;
}

std::vector<Suspect>
suspectsOf(const std::vector<ClosedCycle>& cycles)
{
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> counts; // open, all
  for (const ClosedCycle& closed : cycles)
    for (const std::size_t k : closed.cycle.members()) {
      counts[k].first += closed.closes() ? 0 : 1;
      ++counts[k].second;
    }
  std::vector<Suspect> suspects;
  for (const auto& [k, count] : counts)
    if (count.first == count.second && count.second > 1)
      suspects.push_back({k, count.second});
  return suspects;
}

JointClosure
jointClosureOf(const std::vector<GraphEdge>& edges,
               const std::vector<ClosedCycle>& cycles)
{
  JointClosure joint;
  ErrorRows rows;
  for (const ClosedCycle* closed : independentOf(cycles)) {
    const ErrorTerms terms = errorTermsOf(edges, closed->cycle);
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covarianceOf(terms));
    for (int k = 0; k < 6; ++k) {
      const double deviation = std::sqrt(solver.eigenvalues()[k]);
      const Vector6d direction = solver.eigenvectors().col(k) / deviation;
      if (deviation < max_deviation)
        rows.add(direction.dot(closed->closure.error), direction, terms);
    }
    ++joint.num_cycles;
  }
  joint.num_degrees = rows.size();
  if (joint.num_degrees > 0)
    joint.squared_error = rows.squaredError();
  joint.probability = chanceOf(joint.squared_error, joint.num_degrees);
  return joint;
}

} // namespace bayesian_icp::app
