#include "register/settings_json.h"

#include "io/errors.h"
#include "io/motion.h"
#include "register/choices.h"
#include "register/json_values.h"
#include "register/other_presets.h"
#include "register/setting_fields.h"

#include <set>

namespace bayesian_icp::app {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

struct SettingsWriter {
  ordered_json document = ordered_json::object();

  template <typename T>
  void
  operator()(const Field& field, const T& value)
  {
    ordered_json& place = document[field.group][field.key];
    if constexpr (std::is_enum_v<T>)
      place = toString(value);
    else if constexpr (std::is_integral_v<T>)
      place = value;
    else
      place = jsonOf(value);
  }

  /** The prior mean that is not given is null as a whole. */
  void
  operator()(const Field& field, const Vector6d& value)
  {
    ordered_json& place = document[field.group][field.key];
    if (value.array().isNaN().all())
      place = nullptr;
    else
      place = jsonOf(value);
  }

  template <typename T>
  void
  operator()(const Field& field, const Automatic<T>& value)
  {
    if (value.isGiven())
      (*this)(field, value.valueOr(T()));
    else
      document[field.group][field.key] = "automatic";
  }
};

/** Reads one value; \p path names it in errors. */
class ValueReader {
public:
  ValueReader(const Field& field, const json& value)
  : field_(field)
  , json_(value)
  , path_(std::string(field.group) + '.' + field.key)
  {}

  void
  read(bool& value) const
  {
    if (!json_.is_boolean())
      refuse(path_, json_, "true or false");
    value = json_.get<bool>();
  }

  void
  read(double& value) const
  {
    value = numberOf(json_, "a number");
  }

  void
  read(int& value) const
  {
    const double number = json_.is_number() ? json_.get<double>() : 0.5;
    if (number != std::floor(number) ||
        std::abs(number) > std::numeric_limits<int>::max())
      refuse(path_, json_, "a whole number in its range");
    value = static_cast<int>(number);
  }

  void
  read(std::uint64_t& value) const
  {
    if (!json_.is_number_unsigned())
      refuse(path_, json_, "a whole number in its range");
    value = json_.get<std::uint64_t>();
  }

  void
  read(Vector6d& value) const
  {
    if (json_.is_null() && field_.is_nullable) {
      value.setConstant(field_.null_value);
      return;
    }
    readRow(json_, 6, "six numbers", [&](Eigen::Index k, double x) { value[k] = x; });
  }

  template <typename T>
  void
  read(Automatic<T>& value) const
  {
    value = automatic;
    if (json_ == "automatic")
      return;
    T given = T();
    read(given);
    value = given;
  }

  void
  read(Eigen::Matrix4d& value) const
  {
    const char* expected = "four rows of four numbers";
    if (!json_.is_array() || json_.size() != 4)
      refuse(path_, json_, expected);
    for (Eigen::Index row = 0; row < 4; ++row)
      readRow(json_[static_cast<std::size_t>(row)],
              4,
              expected,
              [&](Eigen::Index k, double x) { value(row, k) = x; });
    const std::string complaint = io::complaintAboutMotion(value);
    if (!complaint.empty())
      throw io::UsageError(path_ + ": " + complaint);
  }

  template <typename Choice>
  std::enable_if_t<std::is_enum_v<Choice>>
  read(Choice& value) const
  {
    if (!json_.is_string() || !readChoice(json_.get<std::string>(), value))
      refuse(path_, json_, namesOfChoices(value));
  }

private:
  double
  numberOf(const json& value, const char* expected) const
  {
    if (value.is_null() && field_.is_nullable)
      return field_.null_value;
    if (!value.is_number())
      refuse(path_, json_, expected);
    return value.get<double>();
  }

  template <typename Set>
  void
  readRow(const json& row, std::size_t size, const char* expected, const Set& set) const
  {
    if (!row.is_array() || row.size() != size)
      refuse(path_, json_, expected);
    for (std::size_t k = 0; k < size; ++k)
      set(static_cast<Eigen::Index>(k), numberOf(row[k], expected));
  }

  const Field& field_;
  const json& json_;
  std::string path_;
};

struct JsonReader {
  const json& document;
  std::set<std::string> known;

  template <typename T>
  void
  operator()(const Field& field, T& value)
  {
    known.insert(field.group);
    known.insert(keyPath(field.group, field.key));
    if (!document.contains(field.group))
      return;
    const json& group = document[field.group];
    if (!group.is_object())
      refuse(field.group, group, "an object");
    if (group.contains(field.key))
      ValueReader(field, group[field.key]).read(value);
  }

  void
  refuseUnknownKeys(Preset preset) const
  {
    for (const auto& [group, content] : document.items()) {
      refuseIfUnknown(group, preset);
      for (const auto& [key, value] : content.items())
        refuseIfUnknown(keyPath(group, key), preset);
    }
  }

  void
  refuseIfUnknown(const std::string& path, Preset preset) const
  {
    if (known.count(path) > 0)
      return;
    refuseOfOtherPresets(path, preset, [&](const Field& field) {
      return path == field.group || path == keyPath(field.group, field.key);
    });
    throw io::UsageError("unknown key " + io::inQuotes(path));
  }
};

} // namespace

ordered_json
jsonOf(const Settings& settings)
{
  SettingsWriter writer;
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
  JsonReader reader{document, {}};
  visitSettings(settings, reader);
  reader.refuseUnknownKeys(settings.options.preset);
  if (document.contains(json::json_pointer("/sgld/step_size")))
    settings.is_step_size_times_points = false;
  if (document.contains(json::json_pointer("/posterior/effective_points")))
    settings.is_effective_points_source_size = false;
  return settings;
}

} // namespace bayesian_icp::app
