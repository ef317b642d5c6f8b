/** \file
 * \brief Preconditioned stochastic gradient Langevin dynamics (SGLD; Welling and Teh
 * 2011, Li et al. 2016). Knows poses and gradients, and nothing of point clouds.
 */
#pragma once

#include "sampler/sampling.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/random.h>

#include <functional>

namespace bayesian_icp {

/** \brief Gradients at a pose with respect to (x, y, z, roll, pitch, yaw). */
struct EnergyGradient {
  /** Of the energy -log p(pose | data), what the chain descends [1/m, 1/rad]. */
  Vector6d energy;
  /** Mean likelihood gradient of the mini-batch, eqs. (2) and (3), what the
   * preconditioner learns from [m, m^2/rad]. */
  Vector6d mini_batch_mean;
};

/** \brief Gradients of the next mini-batch at a pose. */
using MiniBatchGradient = std::function<EnergyGradient(const Vector6d&, Random&)>;

/** \brief Diagonal preconditioner of the paper, eqs. (10) and (11). */
class RmsPropPreconditioner {
public:
  explicit RmsPropPreconditioner(const SgldOptions& options);

  /** \brief Take in the mean gradient of one step.
   * \return the diagonal of A = diag(1 / (lambda_rms + sqrt(V))) */
  Vector6d
  update(const Vector6d& mini_batch_mean_gradient);

private:
  double decay_rate_;
  double lambda_rms_;
  Vector6d mean_square_gradient_;
};

/** \brief Step size of step \p step (counted from 0) of \p num_steps under block decay.
 */
double
stepSizeAt(const SgldOptions& options, long step, long num_steps);

/** \brief One Langevin step, eqs. (5), (8), (9): pose - alpha/2 A gradient + eta with
 * injected noise eta ~ N(0, noise_factor alpha A).
 * \param[in] pose from which the step is made [m, rad]
 * \param[in] energy_gradient of -log posterior there [1/m, 1/rad]
 * \param[in] preconditioner diagonal of A
 * \param[in] step_size alpha of this step
 * \param[in] noise_factor 1 by the paper, 0 for a descent
 * \param[in] random generator of the chain */
Vector6d
sgldStep(const Vector6d& pose,
         const Vector6d& energy_gradient,
         const Vector6d& preconditioner,
         double step_size,
         double noise_factor,
         Random& random);

/** \brief Whether a pose is so far out that the chain has to be stopped. */
using RunsAway = std::function<bool(const Vector6d& pose)>;

/** \brief One chain of Algorithm 1. Its position is the pose [m, rad], whose angles may
 * lie beyond one turn. */
class SgldChain : public SamplingChain {
public:
  /** \param[in] options constants of Algorithm 1; must outlive this object
   * \param[in] num_steps length of the chain, for the block decay of the step size
   * \param[in] start first pose [m, rad]
   * \param[in] gradient draws a mini-batch and gives its gradients
   * \param[in] runs_away whether a finite pose has diverged
   * \param[in] random must outlive this object */
  SgldChain(const SgldOptions& options,
            long num_steps,
            const Vector6d& start,
            MiniBatchGradient gradient,
            RunsAway runs_away,
            Random& random);

  void
  step() override;

  bool
  hasDiverged() const override
  {
    return SamplingChain::hasDiverged() || runs_away_(position_);
  }

  /** \brief Whether an angle moved by more than half a turn in most of the chain's
   * steps. Such a chain is white noise on the circle, whose R-hat and effective sample
   * size are perfect, and no walk through the posterior. */
  bool
  isWhiteNoise() const
  {
    return 2 * num_jumps_ > num_steps_;
  }

private:
  const SgldOptions& options_;
  long num_steps_;
  long steps_made_ = 0;
  long num_jumps_ = 0;
  MiniBatchGradient gradient_;
  RunsAway runs_away_;
  RmsPropPreconditioner preconditioner_;
  Random& random_;
};

} // namespace bayesian_icp
