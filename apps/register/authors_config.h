/** \file
 * \brief The config.json of the paper's authors' program.
 *
 * What that program does with method "preconditioned_sgld", and what becomes of it
 * here: one chain of icp.max-iterations draws without burn-in and block decay; alpha =
 * step-size over the number of source points; N the number of source points; noise
 * variance adjust_noise alpha A; beta = decay-rate; one prior variance for all
 * coordinates; mini-batches from a shuffled source; icp.max-matching-distance as the
 * gate; normalize-cloud scales both clouds, and all lengths of the file are then in
 * scaled units; icp.filter rejects repeated matches of one target point. Its
 * convergence limits concern its optimisers only.
 */
#pragma once

#include "register/settings.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace bayesian_icp::app {

/** \brief Whether a JSON object is of that layout. */
bool
isAuthorsConfig(const nlohmann::json& document);

/** \brief Settings that do what the authors' program does.
 * \param[out] note what is read but has no effect
 * \throws io::UsageError naming the key if it is missing, unknown or malformed, or if
 * it asks for something that is not available */
Settings
settingsOfAuthorsConfig(const nlohmann::json& document, std::string& note);

} // namespace bayesian_icp::app
