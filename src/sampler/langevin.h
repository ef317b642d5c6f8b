/** \file
 * \brief Langevin steps with a preconditioner that was learned before and is now
 * frozen. So no correction for its change is needed (Gamma of preconditioned SGLD is
 * zero).
 */
#pragma once

#include "sampler/gaussian_fit.h"
#include "sampler/sampling.h"

namespace bayesian_icp {

/** \brief Step sizes and lengths of a run. They follow from the noise of the gradients.
 */
struct StepPlan {
  /** L V: the columns are the directions of the steps, scaled to a posterior standard
   * deviation of 1. */
  Matrix6d directions;
  /** b_k, dimensionless; 1 would be a Newton step. */
  Vector6d step_sizes;
  /** s_k: share of the injected noise that the mini-batch already contains. */
  Vector6d noise_shares;
  std::size_t batch_size = 1;
  int num_burn_in = 0;
  int thinning = 1;
};

/** \brief Variances of the gradient of a term, ascending, scaled to a posterior
 * standard deviation of 1. If one of them is above the number n of terms, no batch
 * much smaller than all terms is useful. */
Vector6d
termNoise(const GaussianFit& fit);

/** \brief Plan the steps after a fit.
 * \param[in] fit the Gaussian and the noise of the gradients there
 * \param[in] num_terms n of the energy
 * \param[in] batch_size m; 0 chooses the size with the most effective draws per term
 * \param[in] max_step_size largest b_k, in (0, 1] */
StepPlan
planSteps(const GaussianFit& fit,
          std::size_t num_terms,
          std::size_t batch_size,
          double max_step_size);

/** \brief State of one chain of Leimkuhler and Matthews' scheme (2013). On Gaussians it
 * has the right variance for every step size. */
class LangevinChain : public SamplingChain {
public:
  /** \p gradient and \p random must outlive this object. */
  LangevinChain(const StepPlan& plan,
                const Vector6d& start,
                StochasticGradient& gradient,
                Random& random);

  /** \brief One step with the gradient of the next batch. */
  void
  step() override;

  bool
  hasDiverged() const override
  {
    return gradient_.hasDiverged(position_);
  }

private:
  StepPlan plan_;
  Vector6d noise_amplitudes_;
  StochasticGradient& gradient_;
  Random& random_;
  Vector6d last_noise_;
};

} // namespace bayesian_icp
