#include "samplers/sampler_problem.h"

#include "io/cloud_file.h"
#include "io/picture_numbers.h"
#include "study/draw_statistics.h"

#include <limits>
#include <memory>
#include <numeric>

namespace bayesian_icp::evaluate {

namespace {

constexpr double half_turn = 3.14159265358979323846;

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

} // namespace bayesian_icp::evaluate
