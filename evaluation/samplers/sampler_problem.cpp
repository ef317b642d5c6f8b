#include "samplers/sampler_problem.h"

#include "io/cloud_file.h"
#include "io/output_folder.h"
#include "io/picture_numbers.h"
#include "study/draw_statistics.h"
#include "study/input_hash.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <limits>
#include <memory>
#include <numeric>

namespace bayesian_icp::evaluate {

namespace {

constexpr double half_turn = 3.14159265358979323846;

/** To be changed with the moves of the runs or the energy: old files are then ignored.
 */
constexpr char gold_format[] = "bayesian_icp gold standard 2";

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/** Draws, and what tells whether more time would make them better. */
std::vector<std::uint8_t>
bytesOf(const GoldStandard& gold)
{
  auto chains = nlohmann::json::array();
  for (const PoseMatrix& chain : gold.chains) {
    const Rows rows = chain;
    chains.push_back(std::vector<double>(rows.data(), rows.data() + rows.size()));
  }
  return nlohmann::json::to_cbor({{"format", gold_format},
                                  {"has_converged", gold.has_converged},
                                  {"seconds", gold.seconds},
                                  {"chains", chains}});
}

bool
readFile(const std::string& name, GoldStandard& gold)
{
  std::ifstream stream(name, std::ios::binary);
  if (!stream)
    return false;
  try {
    const auto json = nlohmann::json::from_cbor(stream);
    if (json.at("format") != gold_format)
      return false;
    gold.has_converged = json.at("has_converged");
    gold.seconds = json.at("seconds");
    for (const auto& chain : json.at("chains")) {
      const auto numbers = chain.get<std::vector<double>>();
      gold.chains.push_back(Eigen::Map<const Rows>(
          numbers.data(), static_cast<Eigen::Index>(numbers.size() / 6), 6));
    }
  }
  catch (const nlohmann::json::exception&) {
    return false; // not one of ours, or cut off: made again
  }
  return !gold.chains.empty();
}

void
toTheta(const Problem& problem, GoldStandard& gold)
{
  for (PoseMatrix& chain : gold.chains)
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      chain.row(i) = problem.energy().toTheta(chain.row(i).transpose()).transpose();
}

/** What a gold standard depends on, in one number: points, likelihood, prior, options
 * of its runs. The number of threads and of seconds are left out. */
std::uint64_t
goldKey(const Problem& problem, const GoldOptions& options)
{
  InputHash hash;
  hash.add(gold_format, sizeof gold_format);
  hash.addMatrix(problem.scene().source);
  hash.addMatrix(problem.scene().target.points());
  hash.add(problem.energy().weight());
  hash.addMatrix(problem.energy().prior().mean());
  hash.addMatrix(problem.energy().prior().variance());
  hash.addMatrix(problem.energy().prior().referencePoint());
  hash.add(problem.energy().residual().max_distance);
  if (problem.energy().residual().residual != Residual::PointToPoint)
    hash.add(static_cast<double>(problem.energy().residual().residual));
  for (const double number : {static_cast<double>(options.chains_per_run),
                              static_cast<double>(options.steps_per_round),
                              options.max_rhat,
                              options.max_kl,
                              options.min_ess,
                              static_cast<double>(options.seed)})
    hash.add(number);
  return hash.value();
}

} // namespace

Scene
readScene(const std::string& folder, const std::string& name, std::size_t max_points)
{
  const std::string path = folder + "/" + name + "/";
  const Eigen::Matrix3Xf source = io::readFinitePoints(path + "source.pcd");
  const auto thinned =
      io::evenlySpaced(source.cols(), static_cast<Eigen::Index>(max_points));
  return {name,
          source(Eigen::all, thinned).cast<double>(),
          KdTree(io::readFinitePoints(path + "target.pcd"))};
}

Problem::Problem(const Scene& scene, const Cell& cell, Residual residual)
: scene_(scene)
, cell_(cell)
, residual_{residual}
, target_(treeTargetFor(residual_, scene.target))
, energy_(scene.source,
          target_,
          Prior(Vector6d::Zero(), PriorOptions().variance),
          options(Preset::Exact).exact.scale.weight(),
          residual_)
{}

std::string
Problem::name() const
{
  return residual_.residual == Residual::PointToPoint
             ? scene_.name
             : scene_.name + " " + toString(residual_.residual);
}

Vector6d
Problem::startSpread() const
{
  // With a smaller sigma the posterior is much narrower than the prior.
  constexpr double least_wide_sigma = 0.1; // [m]
  if (cell_.sigma >= least_wide_sigma)
    return PriorOptions().variance.cwiseSqrt();
  Vector6d spread;
  spread << 0.05, 0.05, 0.05, 0.1, 0.1, 0.1;
  return spread;
}

Options
Problem::options(Preset preset) const
{
  Options options;
  options.preset = preset;
  options.paper.scale = options.exact.scale = {cell_.effective_points, cell_.sigma};
  options.exact.residual = residual_;
  options.paper.initial_spread = startSpread();
  options.exact.initial_spread = startSpread();
  return options;
}

GoldTarget
Problem::goldTarget() const
{
  GoldTarget target;
  target.make_energy = [this]() -> EnergyFunction {
    const auto workspace = std::make_shared<EnergyWorkspace>(energy_.makeWorkspace());
    return [this, workspace](const Vector6d& phi) {
      if ((phi.tail<3>().array().abs() > half_turn).any())
        return std::numeric_limits<double>::infinity();
      return energy_.energy(energy_.toTheta(phi), *workspace);
    };
  };
  const Vector6d spread = startSpread();
  target.draw_start = [spread](Random& random) -> Vector6d {
    return spread.cwiseProduct(random.normal6());
  };
  target.start_spread = spread;
  return target;
}

GradientFunction
Problem::makeGradient() const
{
  const auto workspace = std::make_shared<EnergyWorkspace>(energy_.makeWorkspace());
  std::vector<std::size_t> all(energy_.numPoints());
  std::iota(all.begin(), all.end(), std::size_t(0));
  return [this, workspace, all](const Vector6d& phi, Vector6d& gradient) {
    const BatchTerms terms = energy_.batchTerms(
        phi, all, BatchTerms::Gradient, energy_.residual(), *workspace);
    gradient = energy_.weight() * terms.gradient + energy_.priorGradient(phi);
    return energy_.weight() * terms.energy + energy_.priorEnergy(phi);
  };
}

GoldStandard
cachedGold(const Problem& problem,
           const GoldOptions& options,
           const std::string& folder,
           const std::function<void(const std::string&)>& report)
{
  const std::string name =
      "gold_" + io::textOfHash(goldKey(problem, options)) + ".cbor";
  GoldStandard gold;
  if (readFile(folder + "/" + name, gold) &&
      (gold.has_converged || gold.seconds >= options.max_seconds))
    return gold;
  io::OutputFolder output(folder);
  gold = sampleGold(problem.goldTarget(), options, report);
  toTheta(problem, gold);
  const std::vector<std::uint8_t> bytes = bytesOf(gold);
  output.add(name, std::string(bytes.begin(), bytes.end()));
  output.commit();
  return gold;
}

std::string
rowKey(const Problem& problem, const GoldOptions& options, const GoldStandard& gold)
{
  InputHash hash;
  const std::uint64_t inputs = goldKey(problem, options);
  hash.add(&inputs, sizeof inputs);
  for (const PoseMatrix& chain : gold.chains)
    hash.addMatrix(chain);
  return io::textOfHash(gold.has_converged ? inputs : hash.value());
}

} // namespace bayesian_icp::evaluate
