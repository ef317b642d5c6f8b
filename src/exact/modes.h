/** \file
 * \brief Which chains are in one mode of the density, and how much each mode weighs.
 */
#pragma once

#include "sampler/chain_set.h"
#include "sampler/gaussian_fit.h"

#include <vector>

namespace bayesian_icp {

/** \brief Modes that are worse than the best by more than this are dropped [nats]. */
constexpr double max_evidence_loss = 10.0;

/** \brief log of the integral of exp(-U) around \p gaussian, by importance sampling
 * from it; the lowest double if it is not finite. */
double
logEvidence(StochasticEnergy& energy, const Gaussian& gaussian, Random& random);

/** \brief Group chains whose Gaussians overlap, or between which there is no energy
 * barrier.
 * \param[in] energy of any chain: all have the same values */
std::vector<ChainMode>
groupByMode(const std::vector<GaussianFit>& fits, StochasticEnergy& energy);

/** \brief Set the evidence of the modes to the mean of their chains', and put the best
 * mode first.
 * \param[in] log_evidences one per chain */
void
sortByEvidence(const std::vector<double>& log_evidences, std::vector<ChainMode>& modes);

/** \brief Move the chains of clearly worse modes to the first one.
 * \param[in,out] set its modes are in order, the best one first */
void
moveFromWorseModes(ChainSet& set);

/** \brief Merge modes whose draws turn out to overlap. */
void
mergeOverlappingModes(ChainSet& set);

} // namespace bayesian_icp
