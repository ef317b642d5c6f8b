/** \file
 * \brief The list of pairs that pcl_bayesian_icp_batch is to register.
 */
#pragma once

#include "register/settings.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief A pair of clouds, not read yet. */
struct BatchPair {
  std::string name;
  std::string source_file;
  std::string target_file;
  /** File with the 4x4 matrix of the guess; empty if settings has the guess. */
  std::string guess_file;
  Settings settings;
  /** Differs if something that the manifest or the command line says of the pair does:
   * a result with another one is not this pair's. */
  std::string settings_id;

  /** \brief io::stateOf() the files that the pair consists of. */
  std::string
  filesState() const;
};

/** \brief Read a manifest: a JSON list of pairs, as docs/batch.md describes.
 *
 * Files are relative to the manifest.
 * \param[in] settings of pairs that say nothing else
 * \param[in] use_suggested_prior take the prior of each pair's "suggested_prior_sigma"
 * \throws io::FileError naming the pair if something in the manifest is unknown,
 *         malformed or missing */
std::vector<BatchPair>
readManifest(const std::string& file,
             const Settings& settings,
             bool use_suggested_prior);

} // namespace bayesian_icp::app
