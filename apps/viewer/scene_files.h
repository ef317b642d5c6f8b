/** \file
 * \brief Scenes from a registration and from its saved posterior.
 */
#pragma once

#include "register/run.h"
#include "viewer/scene.h"

#include <string>

namespace bayesian_icp::viewer {

/** \brief Clouds and guess of a run, and what came of it if it has taken place. */
Scene
sceneOf(const app::Run& run);

/** \brief A saved posterior, with samples.csv from beside it.
 * \param[in] source_file,target_file empty for the names in the posterior
 * \throws io::FileError if one of the files cannot be read */
Scene
readScene(const std::string& posterior_file,
          const std::string& source_file,
          const std::string& target_file);

} // namespace bayesian_icp::viewer
