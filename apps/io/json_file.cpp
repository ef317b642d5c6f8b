#include "io/json_file.h"

#include "io/input_file.h"

#include <vector>

namespace bayesian_icp::io {

using nlohmann::json;

namespace {

/** Without the library's "[json.exception.parse_error.101] " and without bytes of the
 * file that are no text. */
std::string
reasonOf(const json::exception& error)
{
  std::string text = error.what();
  const std::size_t end_of_tag = text.find("] ");
  if (end_of_tag != std::string::npos)
    text.erase(0, end_of_tag + 2);
  for (char& character : text)
    if (static_cast<unsigned char>(character) >= 0x80)
      character = '?';
  return text;
}

} // namespace

json
readJson(const std::string& name, std::uint64_t max_size)
{
  const std::string text = readText(name, max_size);
  std::vector<std::set<std::string>> keys; // of each object that is open
  const auto check = [&](int depth, json::parse_event_t event, const json& parsed) {
    if (depth > max_json_depth)
      throw FileError(name,
                      "broken JSON: nested more than " +
                          std::to_string(max_json_depth) + " levels deep");
    if (event == json::parse_event_t::object_start)
      keys.emplace_back();
    if (event == json::parse_event_t::object_end)
      keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(parsed).second)
      throw FileError(name,
                      "broken JSON: an object has the key " +
                          inQuotes(parsed.get<std::string>()) + " twice");
    return true;
  };
  try {
    return json::parse(text, check);
  }
  catch (const json::exception& error) {
    throw FileError(name, "broken JSON: " + reasonOf(error));
  }
}

} // namespace bayesian_icp::io
