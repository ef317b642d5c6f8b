/** \file
 * \brief Results of a run, with and without draws: what all presets share.
 */
#pragma once

#include "sampler/chain_set.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/prior.h>

#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief Summarise a run. Diverged chains are reported and left out. Diagnostics use
 * the draws' errors about the coordinateMeans(), over the first draws that all chains
 * have. */
Summary
summarize(const ChainSet& chain_set);

/** \brief Draws of the chains of \p mode, but for diverged ones. */
PoseMatrix
drawsOf(const ChainMode& mode, const std::vector<Chain>& chains);

/** \brief An estimate without draws, whose status says why. */
PosteriorEstimate
failure(Status status, const std::string& message);

/** \brief The draws of a run, their summary and, if there are draws, their \p prior. */
PosteriorEstimate
estimateOf(ChainSet chain_set, const Prior& prior);

/** \brief If there are any, change an Ok to Doubtful, and add them to the message. */
void
addDoubts(const std::vector<std::string>& doubts, Summary& summary);

/** \brief What is wrong with the options, the guess or the source, if anything is. */
std::optional<PosteriorEstimate>
refusalOf(const Eigen::Matrix3Xd& source_points,
          const Vector6d& initial_pose,
          const Options& options);

} // namespace bayesian_icp
