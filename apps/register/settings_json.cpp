#include "register/settings_json.h"

#include "io/json_file.h"
#include "io/motion.h"
#include "register/choices.h"
#include "register/json_values.h"
#include "register/setting_fields.h"

#include <set>

namespace bayesian_icp::app {

namespace {

using io::JsonNode;
using nlohmann::json;
using nlohmann::ordered_json;

double
numberOf(const Field& field, const JsonNode& node)
{
  return field.is_nullable ? node.numberOr(field.null_value) : node.number();
}

/** Reads a value of any type. */
template <typename T>
void
read(const Field& field, const JsonNode& node, T& value)
{
  const json& given = node.json();
  if constexpr (std::is_same_v<T, bool>) {
    if (!given.is_boolean())
      node.refuse("true or false");
    value = given.get<bool>();
  }
  else if constexpr (std::is_same_v<T, double>)
    value = numberOf(field, node);
  else if constexpr (std::is_same_v<T, int>) {
    const double number = given.is_number() ? node.number() : 0.5;
    if (number != std::floor(number) ||
        std::abs(number) > std::numeric_limits<int>::max())
      node.refuse("a whole number in its range");
    value = static_cast<int>(number);
  }
  else if constexpr (std::is_same_v<T, std::uint64_t>) {
    if (!given.is_number_unsigned())
      node.refuse("a whole number in its range");
    value = given.get<std::uint64_t>();
  }
  else if (!given.is_string() || !readChoice(node.text(), value))
    node.refuse(namesOfChoices(value));
}

void
read(const Field& field, const JsonNode& node, Vector6d& value)
{
  if (node.json().is_null() && field.is_nullable) {
    value.setConstant(field.null_value);
    return;
  }
  node.requireList(6);
  for (std::size_t k = 0; k < 6; ++k)
    value[static_cast<Eigen::Index>(k)] = numberOf(field, node[k]);
}

void
read(const Field&, const JsonNode& node, Eigen::Matrix4d& value)
{
  value = node.matrix<Eigen::Matrix4d>();
  const std::string complaint = io::complaintAboutMotion(value);
  if (!complaint.empty())
    node.refuse("a rigid motion: " + complaint);
}

template <typename T>
void
read(const Field& field, const JsonNode& node, Automatic<T>& value)
{
  value = automatic;
  if (node.json() == "automatic")
    return;
  T given = T();
  read(field, node, given);
  value = given;
}

/** \throws io::UsageError if \p path, a group or "group.key", is not \p known */
void
refuseIfUnknown(const std::string& path,
                const std::set<std::string>& known,
                Preset preset)
{
  if (known.count(path) > 0)
    return;
  refuseOfOtherPresets(path, preset);
  throw io::UsageError("unknown key " + io::inQuotes(path));
}

} // namespace

ordered_json
jsonOf(const Settings& settings)
{
  FieldWriter writer;
  visitSettings(settings, writer);
  return std::move(writer.document);
}

Settings
settingsOf(const json& document, const Settings& defaults)
{
  if (!document.is_object())
    throw io::UsageError("the settings are not a JSON object");
  if (document.contains("sgld") && document.contains("calibrated"))
    throw io::UsageError("has settings of several presets, as former versions wrote "
                         "them: keep those of one");
  Settings settings = defaults;
  const JsonNode root(document);
  std::set<std::string> known;
  visitSettings(settings, [&](const Field& field, auto& value) {
    known.insert({field.group, pathOf(field)});
    if (!root.has(field.group))
      return;
    root[field.group].requireObject();
    if (root[field.group].has(field.key))
      read(field, root[field.group][field.key], value);
  });
  for (const auto& [group, content] : document.items()) {
    refuseIfUnknown(group, known, settings.options.preset);
    for (const auto& item : content.items())
      refuseIfUnknown(group + '.' + item.key(), known, settings.options.preset);
  }
  if (document.contains(json::json_pointer("/sgld/step_size")))
    settings.is_step_size_times_points = false;
  if (document.contains(json::json_pointer("/posterior/effective_points")))
    settings.is_effective_points_source_size = false;
  return settings;
}

} // namespace bayesian_icp::app
