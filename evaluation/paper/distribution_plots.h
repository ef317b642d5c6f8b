/** \file
 * \brief Pictures of the distributions, drawn by gnuplot as SVG and PNG.
 */
#pragma once

#include "paper/distribution_tables.h"

#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Draws of a method, with its title. */
using NamedDraws = std::vector<std::pair<std::string, PoseMatrix>>;

/** \brief A run of each method that is shown: Bayesian ICP, exact, calibrated,
 * Online-ICP, those without draws left out. */
NamedDraws
shownDraws(const PaperProblem& problem, const PaperOptions& options);

/** \brief Write densities_PAIR: marginal densities of the baseline and the methods in
 * each coordinate.
 * \throws io::FileError */
void
plotDensities(const std::string& folder,
              const std::string& pair_name,
              const PaperBaseline& baseline,
              const NamedDraws& methods);

/** \brief Write clouds_PAIR: the target and the source as it came, moved by the mean of
 * each of the first methods, and where it belongs.
 * \throws io::FileError */
void
plotClouds(const std::string& folder, const ScanPair& pair, const NamedDraws& methods);

/** \brief Write divergences: KL of every method per pair and coordinate.
 * \throws io::FileError */
void
plotDivergences(const std::string& folder, const Distributions& distributions);

} // namespace bayesian_icp::evaluate
