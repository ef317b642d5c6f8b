/** \file
 * \brief JSON files that may be broken or hostile.
 */
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>

namespace bayesian_icp::io {

/** \brief Deepest nesting of a JSON file that is read: what handles a value later may
 * call itself for each level. */
constexpr int max_json_depth = 64;

/** \brief Parse a JSON file of at most \p max_size bytes.
 * \throws FileError if it cannot be read, or what is wrong with its JSON */
nlohmann::json
readJson(const std::string& name, std::uint64_t max_size);

} // namespace bayesian_icp::io
