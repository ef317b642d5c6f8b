// Stein particles: from the Gaussians of the warm-up to where the particles rest.
#include "exact/preconditioned_run.h"
#include "sampler/stein.h"

#include <algorithm>

namespace bayesian_icp {

namespace {

constexpr int max_gradient_steps = 200, max_newton_steps = 100;
/** Size of a step; from the middle of the run on it decreases, as a rough density lets
 * no particle rest. */
constexpr double step_size = 0.5, step_decay = 0.1;
/** In standard deviations: the longest direction, and the one at which particles rest.
 */
constexpr double max_direction = 2.0, rest = 0.01;

/** Particles in units of the first mode's Gaussian. Chain c has the particles c,
 * c + (number of chains), ... */
class SteinParticles {
public:
  explicit SteinParticles(PreconditionedRun& run)
  : run_(run)
  , is_newton_(run.options.steps == ExactSteps::SteinNewton)
  , positions_(6, run.options.num_particles)
  , gradients_(6, run.options.num_particles)
  , curvatures_(static_cast<std::size_t>(run.options.num_particles))
  {
    for (Eigen::Index p = 0; p < positions_.cols(); ++p) {
      const std::size_t c = chainOf(p);
      const Vector6d x = run.fits[run.modeOf(c)].gaussian.draw(run.chains[c].random);
      positions_.col(p) = unit().inverseFactor() * (x - unit().mean());
    }
  }

  void
  move()
  {
    const int most = is_newton_ ? max_newton_steps : max_gradient_steps;
    run_.state.addSteps(static_cast<long>(most) * run_.chain_options.num_chains);
    int step = 0;
    for (;; ++step) {
      look(step);
      if (step == most || run_.state.stopped())
        break;
      ParticleMatrix steps = is_newton_
                                 ? steinNewtonSteps(positions_, gradients_, curvatures_)
                                 : steinGradientSteps(positions_, gradients_);
      const Eigen::VectorXd lengths = steps.colwise().norm().transpose();
      if (lengths.maxCoeff() < rest)
        break;
      const double size = step_size / (1.0 + step_decay * std::max(0, step - most / 2));
      positions_ +=
          steps *
          (size * (lengths / max_direction).cwiseMax(1.0).cwiseInverse()).asDiagonal();
    }
    const SteinDiscrepancy discrepancy = steinDiscrepancy(positions_, gradients_);
    run_.result.particles = {discrepancy.value, discrepancy.variance_share, step};
  }

  /** Gives the chains of the result their particles. */
  void
  publish() const
  {
    for (std::size_t c = 0; c < run_.chains.size(); ++c) {
      Path path;
      path.positions = Eigen::Map<const ParticleMatrix, 0, Eigen::OuterStride<>>(
          positions_.col(static_cast<Eigen::Index>(c)).data(),
          6,
          numOf(c),
          Eigen::OuterStride<>(6 * numChains()));
      for (auto column : path.positions.colwise()) {
        column = place(column);
        path.has_diverged |= run_.chains[c].energy->hasDiverged(column);
      }
      run_.result.chains[c] = bayesian_icp::chainOf(path, run_.toPoseOf(c));
    }
  }

private:
  const Gaussian&
  unit() const
  {
    return run_.fits.front().gaussian;
  }

  Vector6d
  place(const Vector6d& position) const
  {
    return unit().mean() + unit().factor() * position;
  }

  Eigen::Index
  numChains() const
  {
    return static_cast<Eigen::Index>(run_.chains.size());
  }

  std::size_t
  chainOf(Eigen::Index particle) const
  {
    return static_cast<std::size_t>(particle % numChains());
  }

  Eigen::Index
  numOf(std::size_t chain) const
  {
    return (positions_.cols() - static_cast<Eigen::Index>(chain) + numChains() - 1) /
           numChains();
  }

  /** Gradients and curvatures where the particles are. */
  void
  look(int step)
  {
    const Matrix6d& L = unit().factor();
    run_.forEachChain([&](std::size_t c) {
      auto& chain = run_.chains[c];
      StochasticEnergy& energy = *chain.energy;
      for (auto p = static_cast<Eigen::Index>(c); p < positions_.cols();
           p += numChains()) {
        const Vector6d x = place(positions_.col(p));
        const auto gradient = energy.gradient(x, energy.numTerms(), chain.random);
        gradients_.col(p) = L.transpose() * (gradient.likelihood + gradient.prior);
        // Rough curvatures may be far too small: the Gaussian's, I, is half of them.
        if (is_newton_)
          curvatures_[static_cast<std::size_t>(p)] =
              0.5 * (Matrix6d::Identity() +
                     L.transpose() *
                         (energy.roughCurvature(x) + energy.priorPrecision()) * L);
      }
      run_.state.reportStep(static_cast<int>(c), step, [&] {
        return energy.toPose(place(positions_.col(static_cast<Eigen::Index>(c))));
      });
    });
  }

  PreconditionedRun& run_;
  bool is_newton_;
  ParticleMatrix positions_, gradients_;
  std::vector<Matrix6d> curvatures_;
};

} // namespace

void
sampleParticles(PreconditionedRun& run)
{
  SteinParticles particles(run);
  particles.move();
  particles.publish();
}

} // namespace bayesian_icp
