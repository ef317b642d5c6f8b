#include "determinism_runs.h"

#include <bayesian_icp/random.h>
#include <bayesian_icp/stochastic_gradient_icp.h>
#include <bayesian_icp/tree_search.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace bayesian_icp::test {
namespace {

/** Two scans of a wavy surface of 1 x 0.6 m, each with its own noise. */
struct Scans {
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
};

/** Sides and top of a cube of 0.1 m with noise of 0.5 mm. */
Eigen::Matrix3Xd
cube(std::uint64_t seed, Eigen::Index num_points)
{
  constexpr double half = 0.05, noise = 0.0005;
  Random random(seed, 0);
  Eigen::Matrix3Xd points(3, num_points);
  for (auto point : points.colwise()) {
    const double u = half * (2.0 * random.uniform() - 1.0),
                 v = half * (2.0 * random.uniform() - 1.0);
    double depth = half;
    for (int k = 0; k < 12; ++k)
      depth += noise * (random.uniform() - 0.5);
    const std::size_t face = random.index(5);
    const double side = face % 2 == 0 ? depth : -depth;
    if (face == 4)
      point << u, v, depth;
    else if (face < 2)
      point << side, u, v;
    else
      point << u, side, v;
  }
  return points;
}

/** Each coordinate to the next double, up or down. */
void
nudge(Eigen::Matrix3Xd& points)
{
  Random random(93, 0);
  const double infinity = std::numeric_limits<double>::infinity();
  for (double& coordinate : points.reshaped())
    coordinate =
        std::nextafter(coordinate, random.uniform() < 0.5 ? infinity : -infinity);
}

Scans
makeScans(bool is_nudged)
{
  Scans scans{wavySurface(91, 600), wavySurface(92, 2400)};
  scans.target.colwise() += Eigen::Vector3d(0.01, -0.02, 0.015);
  if (is_nudged)
    nudge(scans.source);
  return scans;
}

/** Ten draws of each of four chains. */
Options
quickOptions(Preset preset, int num_threads)
{
  Options options;
  options.preset = preset;
  options.prior.variance.setConstant(0.01);
  options.chains.num_draws = 40;
  options.chains.num_threads = num_threads;
  return options;
}

RunRecord
recordOf(const Scans& scans, const Options& options)
{
  return test::recordOf(
      estimatePosterior(scans.source, scans.target, Vector6d::Zero(), options));
}

RunRecord
calibratedRun(const RunSettings& settings)
{
  const Scans scans = makeScans(settings.is_nudged);
  const Options options = quickOptions(Preset::Calibrated, settings.num_threads);
  return recordOf(scans, options);
}

/** A cube with four sides that are the same to the bit, where the prior leaves several
 * ways to turn it. */
RunRecord
calibratedModesRun(const RunSettings& settings)
{
  Scans scans{cube(94, 600), Eigen::Matrix3Xd(3, 2400)};
  const Eigen::Matrix3Xd part = cube(95, 600);
  Eigen::Matrix3d quarter_turn;
  quarter_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (int k = 0; k < 4; ++k, turn = (quarter_turn * turn).eval())
    scans.target.middleCols(600 * k, 600) = turn * part;
  if (settings.is_nudged)
    nudge(scans.source);
  Options options = quickOptions(Preset::Calibrated, settings.num_threads);
  options.prior.mean << 0.0, 0.0, 0.0, 0.0, 0.0, 0.1;
  options.prior.variance << 1e-3, 1e-3, 1e-3, 4e-3, 4e-3, 1.0;
  return recordOf(scans, options);
}

/** \p residual and steps of preset `exact`, at one scale. */
RunRecord
exactRun(const RunSettings& settings,
         ExactSteps steps,
         Residual residual = Residual::PointToPoint)
{
  const Scans scans = makeScans(settings.is_nudged);
  Options options = quickOptions(Preset::Exact, settings.num_threads);
  options.exact.scale.effective_points = 100.0;
  options.exact.scale.measurement_sigma = 0.02;
  options.exact.steps = steps;
  options.exact.residual.residual = residual;
  return recordOf(scans, options);
}

/** Six steps of each chain: at the paper's step size every step triples a difference.
 */
RunRecord
paperRun(const RunSettings& settings)
{
  const Scans scans = makeScans(settings.is_nudged);
  Options options = quickOptions(Preset::Paper, settings.num_threads);
  options.chains.num_draws = 24;
  return recordOf(scans, options);
}

/** The pose after each step. */
RunRecord
stochasticGradientRun(const RunSettings& settings)
{
  const Scans scans = makeScans(settings.is_nudged);
  const KdTree tree(scans.target.cast<float>(), settings.num_threads);
  std::vector<Vector6d> path;
  const auto result = stochasticGradientIcp(scans.source,
                                            TreeSearch(tree),
                                            Vector6d::Zero(),
                                            StochasticGradientIcpOptions(),
                                            [&path](int, const Vector6d& pose) {
                                              path.push_back(pose);
                                              return true;
                                            });
  RunRecord record;
  record.outcome = toString(result.end);
  PoseMatrix steps(static_cast<Eigen::Index>(path.size()), 6);
  for (std::size_t i = 0; i < path.size(); ++i)
    steps.row(static_cast<Eigen::Index>(i)) = path[i].transpose();
  record.tables.push_back({"end", result.pose.transpose()});
  record.tables.push_back({"steps", steps});
  return record;
}

/** The runs by their names. */
std::map<std::string, std::function<RunRecord(const RunSettings&)>>
allRuns()
{
  return {
      {"calibrated", calibratedRun},
      {"calibrated_modes", calibratedModesRun},
      {"exact_langevin",
       [](const RunSettings& s) { return exactRun(s, ExactSteps::Langevin); }},
      {"exact_metropolis",
       [](const RunSettings& s) { return exactRun(s, ExactSteps::Metropolis); }},
      {"exact_distributions",
       [](const RunSettings& s) {
         return exactRun(
             s, ExactSteps::Metropolis, Residual::DistributionToDistribution);
       }},
      {"paper", paperRun},
      {"sgd_icp", stochasticGradientRun},
  };
}

} // namespace

Eigen::Matrix3Xd
wavySurface(std::uint64_t seed, Eigen::Index num_points)
{
  constexpr double noise = 0.003;
  Random random(seed, 0);
  Eigen::Matrix3Xd points(3, num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double x = random.uniform() - 0.5;
    const double y = 0.6 * random.uniform() - 0.3;
    double z = 2.0 * x * (x - 0.3) * (x + 0.4) + 3.0 * y * y * (y + 0.2) + 0.3 * x * y;
    // A sum of twelve has the variance 1 and nearly a normal density.
    for (int k = 0; k < 12; ++k)
      z += noise * (random.uniform() - 0.5);
    points.col(i) << x, y, z;
  }
  return points;
}

RunRecord
recordOf(const PosteriorEstimate& estimate)
{
  const Summary& summary = estimate.summary;
  RunRecord record;
  record.outcome = toString(summary.status);
  for (std::size_t k = 0; k < 6; ++k) {
    const CoordinateSummary& c = summary.coordinates[k];
    record.unit[static_cast<Eigen::Index>(k)] = c.standard_deviation;
    record.numbers.insert(record.numbers.end(),
                          {c.rhat, c.bulk_ess, c.tail_ess, c.mcse, c.median});
  }
  const auto append = [&record](const Matrix6d& matrix) {
    record.numbers.insert(
        record.numbers.end(), matrix.data(), matrix.data() + matrix.size());
  };
  for (const Matrix6d& covariance : summary.covariances)
    append(covariance);
  for (const Mode& mode : summary.modes) {
    record.numbers.push_back(mode.weight);
    append(mode.covariance(CovarianceConvention::Parameters));
  }
  record.tables.push_back({"mean", summary.mean.transpose()});
  record.tables.push_back({"standard_deviation", record.unit.transpose()});
  // A row in units of its own coordinate: differences are then those of correlations.
  record.tables.push_back({"covariance_by_standard_deviation",
                           record.unit.cwiseInverse().asDiagonal() *
                               summary.covariance(CovarianceConvention::Parameters)});
  record.tables.push_back({"draws", estimate.samples});
  return record;
}

double
difference(const RunRecord& a, const RunRecord& b)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (a.outcome != b.outcome || a.tables.size() != b.tables.size())
    return infinity;
  double largest = 0.0;
  for (std::size_t i = 0; i < a.tables.size(); ++i) {
    const PoseMatrix &rows = a.tables[i].rows, &others = b.tables[i].rows;
    if (a.tables[i].name != b.tables[i].name || rows.rows() != others.rows())
      return infinity;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const double here = (rows.row(row) - others.row(row))
                              .cwiseQuotient(a.unit.transpose())
                              .cwiseAbs()
                              .maxCoeff<Eigen::PropagateNaN>();
      largest = std::max(largest, std::isnan(here) ? infinity : here);
    }
  }
  return largest;
}

bool
areIdentical(const RunRecord& a, const RunRecord& b)
{
  const auto isSame = [](double x, double y) {
    return x == y || (std::isnan(x) && std::isnan(y));
  };
  return difference(a, b) == 0.0 && a.unit == b.unit &&
         std::equal(a.numbers.begin(),
                    a.numbers.end(),
                    b.numbers.begin(),
                    b.numbers.end(),
                    isSame);
}

std::vector<std::string>
runNames()
{
  std::vector<std::string> names;
  for (const auto& [name, make] : allRuns())
    names.push_back(name);
  return names;
}

RunRecord
makeRun(const std::string& name, const RunSettings& settings)
{
  return allRuns().at(name)(settings);
}

} // namespace bayesian_icp::test
