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

/** Reads one value. */
class ValueReader {
public:
  ValueReader(const Field& field, const JsonNode& value) : field_(field), value_(value)
  {}

  void
  read(bool& value) const
  {
    if (!value_.json().is_boolean())
      value_.refuse("true or false");
    value = value_.json().get<bool>();
  }

  void
  read(double& value) const
  {
    value = numberOf(value_);
  }

  void
  read(int& value) const
  {
    const double number = value_.json().is_number() ? value_.number() : 0.5;
    if (number != std::floor(number) ||
        std::abs(number) > std::numeric_limits<int>::max())
      value_.refuse("a whole number in its range");
    value = static_cast<int>(number);
  }

  void
  read(std::uint64_t& value) const
  {
    if (!value_.json().is_number_unsigned())
      value_.refuse("a whole number in its range");
    value = value_.json().get<std::uint64_t>();
  }

  void
  read(Vector6d& value) const
  {
    if (value_.json().is_null() && field_.is_nullable) {
      value.setConstant(field_.null_value);
      return;
    }
    value_.requireList(6);
    for (std::size_t k = 0; k < 6; ++k)
      value[static_cast<Eigen::Index>(k)] = numberOf(value_[k]);
  }

  template <typename T>
  void
  read(Automatic<T>& value) const
  {
    value = automatic;
    if (value_.json() == "automatic")
      return;
    T given = T();
    read(given);
    value = given;
  }

  void
  read(Eigen::Matrix4d& value) const
  {
    value = value_.matrix<Eigen::Matrix4d>();
    const std::string complaint = io::complaintAboutMotion(value);
    if (!complaint.empty())
      value_.refuse("a rigid motion: " + complaint);
  }

  template <typename Choice>
  std::enable_if_t<std::is_enum_v<Choice>>
  read(Choice& value) const
  {
    if (!value_.json().is_string() || !readChoice(value_.text(), value))
      value_.refuse(namesOfChoices(value));
  }

private:
  double
  numberOf(const JsonNode& value) const
  {
    return field_.is_nullable ? value.numberOr(field_.null_value) : value.number();
  }

  const Field& field_;
  const JsonNode& value_;
};

struct JsonReader {
  const JsonNode document;
  /** Groups, and "group.key". */
  std::set<std::string> known;

  template <typename T>
  void
  operator()(const Field& field, T& value)
  {
    known.insert(field.group);
    known.insert(pathOf(field));
    if (!document.has(field.group))
      return;
    document[field.group].requireObject();
    if (document[field.group].has(field.key))
      ValueReader(field, document[field.group][field.key]).read(value);
  }

  void
  refuseUnknownKeys(Preset preset) const
  {
    for (const auto& [group, content] : document.json().items()) {
      refuseIfUnknown(group, preset);
      for (const auto& item : content.items())
        refuseIfUnknown(group + '.' + item.key(), preset);
    }
  }

  void
  refuseIfUnknown(const std::string& path, Preset preset) const
  {
    if (known.count(path) > 0)
      return;
    refuseOfOtherPresets(path, preset);
    throw io::UsageError("unknown key " + io::inQuotes(path));
  }
};

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
  JsonReader reader{JsonNode(document), {}};
  visitSettings(settings, reader);
  reader.refuseUnknownKeys(settings.options.preset);
  if (document.contains(json::json_pointer("/sgld/step_size")))
    settings.is_step_size_times_points = false;
  if (document.contains(json::json_pointer("/posterior/effective_points")))
    settings.is_effective_points_source_size = false;
  return settings;
}

} // namespace bayesian_icp::app
