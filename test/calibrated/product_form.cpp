#include "calibrated/product_form.h"

#include "calibrated/draws/product_coordinates.h"
#include "sampler/sampling.h"

#include <cmath>

namespace bayesian_icp {
namespace test {

namespace {

constexpr int num_burn_in = 20;

/** Proposals of b alone keep this part of its deviation from the mean. */
constexpr double kept_deviation = 0.6;

/** Proposals along motions held by the prior only, in standard deviations. */
constexpr double walk_scale = 2.0;

/** One Metropolis chain in product coordinates. */
class ProductFormChain : public SamplingChain {
public:
  ProductFormChain(const ProductCoordinates& coordinates,
                   const Prior& prior,
                   Random& random)
  : SamplingChain(coordinates.gaussian().mean())
  , coordinates_(coordinates)
  , prior_(prior)
  , random_(random)
  , walk_scales_(Vector6d::Zero())
  , held_(Vector6d::Ones())
  , energy_(energyAt(position_))
  {
    const int num_walking = coordinates.numPriorOnly();
    walk_scales_.head(num_walking) =
        walk_scale *
        coordinates.gaussian().covariance().diagonal().cwiseSqrt().head(num_walking);
    held_.head(num_walking).setZero();
  }

  void
  step() override
  {
    proposeAnywhere();
    proposeHeld();
    if (coordinates_.numPriorOnly() > 0)
      acceptOrStay(position_ + walk_scales_.cwiseProduct(random_.normal6()), 0.0);
  }

private:
  double
  energyAt(const Vector6d& z) const
  {
    return coordinates_.linearEnergy(z) +
           prior_.energy(poseOf(coordinates_.pose(z).matrix()));
  }

  /** A draw of the calibrated Gaussian. */
  void
  proposeAnywhere()
  {
    const Gaussian& gaussian = coordinates_.gaussian();
    const Vector6d proposal = gaussian.draw(random_);
    acceptOrStay(proposal, gaussian.energy(proposal) - gaussian.energy(position_));
  }

  /** Another b at the same a: where the prior has more than a Gaussian's tails in a,
   * proposeAnywhere() is never accepted. L is upper triangular, so that b - E b is that
   * of a draw, and Gaussian. */
  void
  proposeHeld()
  {
    const Gaussian& gaussian = coordinates_.gaussian();
    const Vector6d old = held_.cwiseProduct(position_ - gaussian.mean());
    const Vector6d other =
        held_.cwiseProduct(gaussian.factor() * held_.cwiseProduct(random_.normal6()));
    const Vector6d next =
        kept_deviation * old + std::sqrt(1.0 - kept_deviation * kept_deviation) * other;
    const auto energyOf = [&](const Vector6d& deviation) {
      // Zero a: L^-1 of the last rows.
      return 0.5 *
             held_.cwiseProduct(gaussian.inverseFactor() * deviation).squaredNorm();
    };
    acceptOrStay(position_ - old + next, energyOf(next) - energyOf(old));
  }

  void
  acceptOrStay(const Vector6d& proposal, double log_proposal_ratio)
  {
    const double energy = energyAt(proposal);
    if (std::log(random_.uniform()) >= energy_ - energy + log_proposal_ratio)
      return;
    position_ = proposal;
    energy_ = energy;
  }

  const ProductCoordinates& coordinates_;
  const Prior& prior_;
  Random& random_;
  Vector6d walk_scales_;
  /** 1 where b is, 0 where a is. */
  Vector6d held_;
  double energy_;
};

} // namespace

ChainSet
sampleProductForm(const Prior& prior, const CalibratedEstimate& estimate, int thinning)
{
  const ChainOptions options;
  const ProductCoordinates coordinates(estimate);
  const auto to_pose = [&](const Vector6d& z) {
    return poseOf(coordinates.pose(z).matrix());
  };
  const ProgressCallback nobody;
  RunState run(nobody);
  ChainSet result;
  for (int i = 0; i < options.num_chains; ++i) {
    Random random(options.seed, static_cast<std::uint64_t>(i));
    ProductFormChain chain(coordinates, prior, random);
    Path path;
    const Schedule schedule = {num_burn_in, thinning, options.numDrawsOf(i)};
    advance(chain, schedule, to_pose, i, run, path);
    result.chains.push_back(chainOf(path, to_pose));
  }
  return result;
}

} // namespace test
} // namespace bayesian_icp
